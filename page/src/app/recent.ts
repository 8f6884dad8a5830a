import type { OpenRequest } from "./editor";
import { remembered } from "./remembered";

/** Paths of models and edit files that were opened, the last one first. */
export const recentPaths = remembered<string[]>("recent", []);

const most = 6;

export function rememberOpened({ path }: OpenRequest): void {
  if (path === undefined) return;
  recentPaths.value = [path, ...recentPaths.value.filter((one) => one !== path)].slice(0, most);
}

/** What was left with changes that are not saved: paths and samples. */
const unsaved = remembered<string[]>("unsaved", []);

const nameOf = ({ path, sample }: OpenRequest): string | undefined => path ?? (sample && `sample ${sample}`);

/** Remembers of what is open whether it has changes that are not saved. */
export function rememberUnsaved(open: OpenRequest | undefined, isDirty: boolean): void {
  const name = open && nameOf(open);
  if (name === undefined || unsaved.value.includes(name) === isDirty) return;
  unsaved.value = [...unsaved.value.filter((one) => one !== name), ...(isDirty ? [name] : [])];
}
export function wasLeftUnsaved(request: OpenRequest): boolean {
  return unsaved.value.includes(nameOf(request) ?? "");
}

const openKey = "meshgraft open";

/** What this tab has open: it is taken up again when the page is loaded again. */
export function rememberOpen(open: OpenRequest): void {
  try {
    sessionStorage.setItem(openKey, JSON.stringify(open));
  } catch {
    // Then it has to be opened by hand.
  }
}
/** What was open before the page was loaded again. */
export function openBeforeReload(): OpenRequest | undefined {
  const [loaded] = performance.getEntriesByType("navigation") as PerformanceNavigationTiming[];
  if (loaded?.type !== "reload") return undefined;
  try {
    return JSON.parse(sessionStorage.getItem(openKey) ?? "null") ?? undefined;
  } catch {
    return undefined;
  }
}

/** Those that may be opened now, and are not offered anyway. */
export function recentIn(folders: readonly string[], offered: readonly string[]): string[] {
  return recentPaths.value.filter(
    (path) => !offered.includes(path) && folders.some((folder) => path.startsWith(folder.endsWith("/") ? folder : `${folder}/`)),
  );
}
