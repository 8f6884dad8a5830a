import { batch } from "@preact/signals";
import type { DialogName, Editor } from "./editor";
import { remembered } from "./remembered";

/** A control of the page by its label, and what has to be unfolded to see it. */
export interface Place {
  readonly mode?: "deform" | "graft";
  readonly dialog?: DialogName;
  readonly section?: string;
  /** The block of rarely needed fields within the section. */
  readonly more?: string;
  /** Absent: the section's title. */
  readonly control?: string;
}

const shownMs = 2500; // how long the place is marked

/** Unfolds what hides a place, then scrolls there, focuses the control and marks it for a moment. */
export async function reveal({ view, graft, dialog }: Editor, place: Place): Promise<void> {
  batch(() => {
    if (place.dialog !== undefined) dialog.value ??= place.dialog; // an open dialog has the control itself
    else view.panels.value = true;
    if (place.mode !== undefined) graft.mode.value = place.mode;
    if (place.section !== undefined) remembered(`section ${place.section}`, true).value = true;
    if (place.more !== undefined) remembered(`more ${place.more}`, true).value = true;
  });
  await drawn();
  const section = place.section === undefined ? document : document.querySelector(`section[aria-label="${place.section}"]`);
  const control = controlIn(section, place.control) ?? section?.querySelector<HTMLElement>("h2 button");
  if (control == null) return;
  control.focus({ preventScroll: true });
  const row = control.closest<HTMLElement>(".row, .list-main") ?? control;
  row.scrollIntoView({ block: "center" });
  row.classList.add("pointed-at");
  setTimeout(() => row.classList.remove("pointed-at"), shownMs);
}

/** Resolves once the page shows what the signals say now. A tab in the background draws no frames. */
function drawn(): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, 50));
}

function controlIn(scope: ParentNode | null, name: string | undefined): HTMLElement | undefined {
  if (scope === null || name === undefined) return undefined;
  const all = [...scope.querySelectorAll<HTMLElement>("button, input, select, summary")];
  const named = all.filter((control) => nameOf(control) === name || groupOf(control) === name);
  return named.find((control) => control instanceof HTMLInputElement && control.checked) ?? named[0];
}

function nameOf(control: HTMLElement): string {
  const label = control.getAttribute("aria-label") ?? textOf(control.getAttribute("aria-labelledby"));
  if (label !== "") return label;
  const [first] = control instanceof HTMLInputElement || control instanceof HTMLSelectElement ? (control.labels ?? []) : [control];
  return first?.textContent?.trim() ?? "";
}

/** Returns the name of the group of choices that a control belongs to. */
function groupOf(control: HTMLElement): string {
  return textOf(control.closest('[role="radiogroup"]')?.getAttribute("aria-labelledby") ?? null);
}

function textOf(id: string | null): string {
  return (id === null ? null : document.getElementById(id))?.textContent?.trim() ?? "";
}
