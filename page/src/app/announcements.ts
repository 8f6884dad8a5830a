import type { Outcome } from "../engine/connection";
import type { Change, DocumentState, PageRequest } from "../protocol";
import { printProblems } from "./print_words";
import { changeLabel } from "./request_labels";
import { counted } from "./units";

type Before = Pick<DocumentState, "undo" | "redo" | "graft"> | null;
type RequestOf<Do> = Extract<PageRequest, { do: Do }>;

/** The requests whose answers need no words of their own, with the reason. */
export const withoutWords = {
  "add-folder": "the field where a folder is added says so; folders of earlier sessions are added without an act",
  discard: "a message says so",
  done: "the page says so, and is closed",
  drag: "it goes on; the pose at its end has words",
  export: "a message says so",
  "graft-drag": "it goes on; the graft at its end has words",
  list: "the list is read",
  loops: "the view asks for them",
  open: "said with the sizes of the model, once it is shown",
  repair: "a message says what was mended",
  save: "a message says so",
  state: "the page asks for it",
  thumbnail: "the page asks for pictures by itself",
} as const satisfies Partial<Record<PageRequest["do"], string>>;

const fixedWords: Partial<Record<PageRequest["do"], string>> = {
  accept: "The step is accepted. The next one begins.",
  cancel: "Cancelled.",
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
    case "graft":
      return graftWords(request, before);
    case "part":
      return partWords(request, outcome);
    case "mark":
      return outcome.marked === undefined || outcome.marked === 0 ? undefined : `${counted(outcome.marked, "place")} lit up.`;
    case "print-check":
      return printWords(request, outcome);
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

function graftWords(request: RequestOf<"graft">, before: Before): string {
  if ("what" in request && request.what !== undefined && request.what !== "set")
    return {
      cancel: "The graft is cancelled.",
      swap: "Part and model are exchanged.",
      resume: "The graft is edited again.",
    }[request.what];
  if (before === null || before.graft !== null) return "The graft is changed.";
  return "source" in request && typeof request.source === "string" ? `The graft of ${request.source} begins.` : "The graft begins.";
}

function partWords(request: RequestOf<"part">, { name }: Outcome): string {
  switch (request.what) {
    case "add":
      return `${name ?? "The part"} is added as a part.`;
    case "remove":
      return `${request.name} is removed.`;
    case "edit":
      return `${request.name} is the model now.`;
    case "withdraw":
      return `${request.name} is not added.`;
  }
}

function printWords({ least_wall = 0, overhang_deg = 45 }: RequestOf<"print-check">, { print }: Outcome): string | undefined {
  if (print === undefined) return undefined;
  const problems = printProblems(print, { leastWall: least_wall, overhangDeg: overhang_deg, unit: "none" });
  return `Checked for printing: ${problems.length === 0 ? "nothing stands against it" : problems.map(({ words }) => words).join("; ")}.`;
}

function handleWords({ what, name }: RequestOf<"handle">): string {
  const done = { add: "made", remove: "removed", rename: "renamed" };
  return `${name ?? "The handle"} is ${done[what]}.`;
}
