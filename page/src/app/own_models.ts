import { baseName, compareNames, isWithin } from "./paths";

/** A model or an edit file of a folder, or of one within. */
export interface FolderFile {
  readonly path: string;
  /** The path from the folder that was listed. */
  readonly name: string;
  readonly unsaved: boolean;
}

/** The files of folders, and the folders of which these are all files. */
export interface OwnFiles {
  readonly whole: readonly string[];
  readonly files: readonly FolderFile[];
}

/**
 * Returns the user's own files whose names are found, each once: those opened last that are still there, those of the
 * command line, then those of the folders by name, with those of folders within last.
 */
export function ownModels(
  recent: readonly string[],
  given: readonly string[],
  { whole, files }: OwnFiles,
  isFound: (name: string) => boolean,
): string[] {
  const depth = (name: string) => name.split("/").length;
  const inOrder = [...files].sort(
    (a, b) => depth(a.name) - depth(b.name) || compareNames(baseName(a.path), baseName(b.path)),
  );
  const names = new Map(inOrder.map(({ path, name }) => [path, name]));
  const isThere = (path: string) => names.has(path) || !whole.some((folder) => isWithin(folder, path));
  const own = new Set([...recent.filter(isThere), ...given, ...names.keys()]);
  return [...own].filter((path) => isFound(names.get(path) ?? baseName(path)));
}

/** Returns whether a name has all words that are searched for, whatever their case and accents. */
export function isFoundBy(search: string): (name: string) => boolean {
  const words = plain(search).split(/\s+/);
  return (name) => words.every((word) => plain(name).includes(word));
}

function plain(text: string): string {
  return text.normalize("NFD").replace(/\p{Diacritic}/gu, "").toLowerCase();
}
