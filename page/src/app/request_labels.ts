import type { Change, PageRequest } from "../protocol";

const labels: Partial<Record<string, string>> = {
  open: "Opening",
  list: "Reading the folder",
  restore: "Restoring",
  accept: "Accepting the step",
  undo: "Undoing",
  redo: "Redoing",
  reset: "Resetting",
  select: "Selecting",
  group: "Saving the group",
  "paint-handle": "Making the handle",
  reach: "Changing the reach",
  region: "Setting the region",
  fixed: "Setting the fixed vertices",
  handle: "Changing the handle",
  pose: "Moving",
  settings: "Changing the method",
  part: "Opening the part",
  loops: "Finding boundary loops",
  thumbnail: "Making a picture",
  "add-folder": "Adding a folder",
  cut: "Cutting",
  mark: "Finding the places",
  repair: "Mending",
  "print-check": "Checking for printing",
  transform: "Moving the model",
  sculpt: "Shaping",
  graft: "Grafting",
  "graft-drag": "Grafting",
  save: "Saving",
  export: "Exporting",
  done: "Returning the mesh",
  step: "Changing the step",
  symmetry: "Setting the symmetry",
};

/** Returns a label for a request, for the user who waits. */
export function labelOf(request: PageRequest): string {
  return labels[request.do] ?? "Working";
}

/** Words for the changes of a document. */
const changes: Record<Change, string> = {
  pose: "move",
  reach: "reach",
  region: "region",
  fixed: "fixed vertices",
  settings: "method settings",
  accept: "accepted step",
  cut: "cut",
  repair: "mending",
  transform: "size and place",
  sculpt: "shaping",
  graft: "graft",
  group: "group",
  reset: "reset",
  paint_handle: "painted handle",
  add_handle: "new handle",
  remove_handle: "removed handle",
  rename_handle: "renamed handle",
  remove_part: "removed part",
  edit_part: "part made the model",
  add_part: "new part",
  drop_part: "dropped part",
  change_step: "changed step",
  remove_step: "removed step",
  rename_step: "renamed step",
  remove_group: "removed group",
  symmetry_off: "symmetry off",
  symmetry: "symmetry",
  resume_graft: "editing a graft again",
  start_graft: "start of a graft",
  cancel_graft: "cancelled graft",
  colour: "colour of a group",
};

/** Returns words for a change of the document. */
export function changeLabel(change: Change): string {
  return changes[change];
}
