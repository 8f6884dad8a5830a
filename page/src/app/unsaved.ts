import type { DocumentState } from "../protocol";

/**
 * Returns whether a document has changes that are not saved. After a restore the engine does not know which state is
 * saved and calls all of them unsaved (`dirty`). A model that was never saved as an edit and has no change left is as its
 * file, though. `wasSaved`: whether it was saved before it was restored.
 */
export function hasUnsavedChanges({ dirty, edit, undo }: Pick<DocumentState, "dirty" | "edit" | "undo">, wasSaved: boolean): boolean {
  const isAsOpened = undo === null && edit === "" && !wasSaved;
  return dirty && !isAsOpened;
}
