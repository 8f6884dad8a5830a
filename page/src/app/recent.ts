import type { OpenRequest } from "./editor";
import { remembered } from "./remembered";

/** Paths of models and edit files that were opened, the last one first. */
export const recentPaths = remembered<string[]>("recent", []);

const most = 6;

export function rememberOpened({ path }: OpenRequest): void {
  if (path === undefined) return;
  recentPaths.value = [path, ...recentPaths.value.filter((one) => one !== path)].slice(0, most);
}

/** Those that may be opened now, and are not offered anyway. */
export function recentIn(folders: readonly string[], offered: readonly string[]): string[] {
  return recentPaths.value.filter(
    (path) => !offered.includes(path) && folders.some((folder) => path.startsWith(folder.endsWith("/") ? folder : `${folder}/`)),
  );
}
