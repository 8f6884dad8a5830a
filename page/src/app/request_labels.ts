import type { PageRequest } from "../protocol";

const labels: Partial<Record<string, string>> = {
  open: "Opening",
  list: "Looking into the folder",
  restore: "Restoring",
  accept: "Accepting the step",
  undo: "Undoing",
  redo: "Redoing",
  reset: "Going back to the start",
  select: "Selecting",
  group: "Keeping the selection",
  "paint-handle": "Making the handle",
  reach: "Changing the reach",
  region: "Setting the region",
  fixed: "Setting the fixed part",
  handle: "Changing the handle",
  pose: "Moving",
  settings: "Changing the method",
  part: "Opening the part",
  loops: "Finding boundary loops",
  thumbnail: "Making a picture",
  cut: "Cutting",
  graft: "Grafting",
  save: "Saving",
  export: "Exporting",
  step: "Changing the step",
  symmetry: "Setting the symmetry",
};

/** Returns a label for a request, for the user who waits. */
export function labelOf(request: PageRequest): string {
  return labels[request.do] ?? "Working";
}

/** Rewrites the engine's names of changes (`undo`, `redo` of the state) in the words of the panels. */
export function changeLabel(label: string | null): string {
  const words: Partial<Record<string, string>> = {
    pose: "move",
    reach: "reach",
    region: "region",
    fixed: "fixed part",
    settings: "method settings",
    accept: "accepted step",
    part: "part",
    cut: "cut",
    graft: "graft",
    group: "group",
    reset: "reset",
  };
  return label === null ? "" : (words[label] ?? label);
}
