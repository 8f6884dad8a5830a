import type { OpenRequest } from "./editor";
import { changeRemembered, remembered } from "./remembered";

/** Paths of models and edit files that were opened, latest first. */
export const recentPaths = remembered<string[]>("recent", []);

const most = 6;

export function rememberOpened({ path }: OpenRequest): void {
  if (path === undefined) return;
  changeRemembered<string[]>("recent", (stored) => [path, ...stored.filter((one) => one !== path)].slice(0, most));
}

/** Paths and samples that were left with unsaved changes. */
const unsaved = remembered<string[]>("unsaved", []);

const nameOf = ({ path, sample }: OpenRequest): string | undefined => path ?? (sample && `sample ${sample}`);

/** Records whether the open document has unsaved changes. */
export function rememberUnsaved(open: OpenRequest, isUnsaved: boolean): void {
  const name = nameOf(open);
  if (name === undefined || unsaved.value.includes(name) === isUnsaved) return;
  changeRemembered<string[]>("unsaved", (stored) => [...stored.filter((one) => one !== name), ...(isUnsaved ? [name] : [])]);
}
export function wasLeftUnsaved(request: OpenRequest): boolean {
  return unsaved.value.includes(nameOf(request) ?? "");
}

const openKey = () => `meshgraft open ${location.pathname}`; // by path, as for the token

/** Records the open document of this tab, so that it is reopened after a reload. */
export function rememberOpen(open: OpenRequest): void {
  try {
    sessionStorage.setItem(openKey(), JSON.stringify(open));
  } catch {
    // The document then has to be opened by hand.
  }
}
/** Returns the document that was open before a reload; undefined if the page was not reloaded. */
export function openBeforeReload(): OpenRequest | undefined {
  const [loaded] = performance.getEntriesByType("navigation") as PerformanceNavigationTiming[];
  if (loaded?.type !== "reload") return undefined;
  try {
    return JSON.parse(sessionStorage.getItem(openKey()) ?? "null") ?? undefined;
  } catch {
    return undefined;
  }
}

/** Returns the recent paths that may be opened now and are not offered elsewhere. */
export function recentIn(folders: readonly string[], offered: readonly string[]): string[] {
  return recentPaths.value.filter(
    (path) => !offered.includes(path) && folders.some((folder) => path.startsWith(folder.endsWith("/") ? folder : `${folder}/`)),
  );
}
