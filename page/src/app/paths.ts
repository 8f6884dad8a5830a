// File names as the engine's machine writes them.
const collator = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });

/** Compares names as people sort them: part 2 before part 10, ignoring case. */
export function compareNames(a: string, b: string): number {
  return collator.compare(a, b) || (a < b ? -1 : 1);
}

export function baseName(path: string): string {
  return path.slice(path.lastIndexOf("/") + 1);
}
export function folderOf(path: string): string {
  return path.slice(0, Math.max(1, path.lastIndexOf("/")));
}
export function joined(folder: string, name: string): string {
  return folder.endsWith("/") ? folder + name : `${folder}/${name}`;
}
/** Returns whether a folder is or contains this path, at any depth. */
export function isWithin(folder: string, path: string): boolean {
  return path === folder || path.startsWith(joined(folder, ""));
}
export function stemOf(name: string): string {
  const base = baseName(name);
  const dot = base.lastIndexOf(".");
  return dot > 0 ? base.slice(0, dot) : base;
}
/** Returns `name` with this extension (".ply"). It replaces an extension of a mesh or an edit file, or is appended. */
export function withExtension(name: string, extension: string): string {
  return name.replace(/\.(json|ply|obj|off|stl|glb|gltf|3mf)$/i, "") + extension;
}

export interface MeshFormat {
  extension: string;
  label: string;
  keeps: string;
  morphTargets?: boolean;
}

/** The formats in which meshes can be written, and the data that each keeps (docs/files.md). */
export const meshFormats: readonly MeshFormat[] = [
  { extension: ".ply", label: "PLY", keeps: "Vertex order, colours and whatever else the vertices have." },
  { extension: ".obj", label: "OBJ", keeps: "Vertex order, UVs with their seams, groups and materials." },
  { extension: ".glb", label: "glTF, one file", keeps: "For the web and game engines, with textures.", morphTargets: true },
  { extension: ".gltf", label: "glTF", keeps: "The same in several files.", morphTargets: true },
  { extension: ".stl", label: "STL", keeps: "Triangles alone, for printing." },
  { extension: ".3mf", label: "3MF", keeps: "For printing, with the unit and colours." },
  { extension: ".off", label: "OFF", keeps: "Vertices and faces alone." },
];

/** Returns why a name cannot be used for a file; undefined if it can. */
export function faultOfName(name: string): string | undefined {
  if (name.trim() === "") return "Give it a name.";
  if (name.includes("/") || name.includes("\\")) return "A name has no slashes. Choose the folder above.";
  if (name.startsWith(".")) return "A name that starts with a dot is hidden from view.";
  return undefined;
}
