import type { Outcome } from "../engine/connection";
import type { Change, DocumentState, PageRequest } from "../protocol";
import { changeLabel } from "./request_labels";
import { counted } from "./units";

type Before = Pick<DocumentState, "undo" | "redo"> | null;

const fixedWords: Partial<Record<PageRequest["do"], string>> = {
  accept: "The step is accepted. The next one begins.",
  cut: "Cut.",
  fixed: "The selected vertices are fixed.",
  reach: "The reach is set.",
  region: "Only the selected vertices may move.",
  reset: "The step is reset.",
  restore: "The changes are restored.",
  sculpt: "Shaped.",
  settings: "The settings are changed.",
  transform: "The model is moved or scaled.",
};

/**
 * Returns what a screen reader is told once a request is done: what came of it. Undefined where a message says it
 * already, or nothing has changed for the user.
 */
export function announcementOf(request: PageRequest, outcome: Outcome, before: Before): string | undefined {
  switch (request.do) {
    case "undo":
      return changeWords("Undone", before?.undo ?? null);
    case "redo":
      return changeWords("Redone", before?.redo ?? null);
    case "select":
      return outcome.selected === undefined ? undefined : selectionWords(outcome.selected);
    case "paint-handle":
      return `${request.name ?? "The handle"} is made.`;
    case "handle":
      return handleWords(request);
    case "pose":
      return `${Object.keys(request.poses).join(", ")}: moved.`;
    case "group":
      return request.remove === true ? `The group ${request.name} is removed.` : `The group ${request.name} is saved.`;
    case "symmetry":
      return request.plane === null ? "Symmetry is off." : "Symmetry is on.";
    case "step":
      return { change: "The step is changed.", remove: "The step is removed.", rename: "The step is renamed." }[request.what];
    default:
      return fixedWords[request.do];
  }
}

/** Returns what a screen reader is told about the number of selected vertices. */
export function selectionWords(selected: number): string {
  return selected === 0 ? "Nothing is selected." : `${counted(selected, "vertex", "vertices")} selected.`;
}

/** Returns what a screen reader is told about a document that was opened. */
export function openedWords({ name, model }: Pick<DocumentState, "name" | "model">): string {
  return `${name} is open: ${counted(model.vertices, "vertex", "vertices")}, ${counted(model.faces, "face")}.`;
}

function changeWords(done: string, change: Change | null): string | undefined {
  return change === null ? undefined : `${done}: ${changeLabel(change)}.`;
}

function handleWords({ what, name }: Extract<PageRequest, { do: "handle" }>): string {
  const done = { add: "made", remove: "removed", rename: "renamed" };
  return `${name ?? "The handle"} is ${done[what]}.`;
}
