import { baseName, compareNames, folderOf } from "./paths";

/** A model or an edit file of a folder. */
export interface FolderFile {
  readonly path: string;
  readonly unsaved: boolean;
}

/** The files of the folders that could be read. */
export interface OwnFiles {
  readonly read: readonly string[];
  readonly files: readonly FolderFile[];
}

/**
 * Returns the user's own files, each once: those opened last that are still there, those of the command line, then those
 * of the folders by name.
 */
export function ownModels(recent: readonly string[], given: readonly string[], { read, files }: OwnFiles): string[] {
  const byName = files.map(({ path }) => path).sort((a, b) => compareNames(baseName(a), baseName(b)));
  const known = new Set(byName);
  const isThere = (path: string) => known.has(path) || !read.includes(folderOf(path));
  return [...new Set([...recent.filter(isThere), ...given, ...byName])];
}

/** Returns whether a name has all words that are searched for, whatever their case and accents. */
export function isFoundBy(search: string): (name: string) => boolean {
  const words = plain(search).split(/\s+/);
  return (name) => words.every((word) => plain(name).includes(word));
}

function plain(text: string): string {
  return text.normalize("NFD").replace(/\p{Diacritic}/gu, "").toLowerCase();
}
