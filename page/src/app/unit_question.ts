import type { DocumentState } from "../protocol";
import type { ViewSettings } from "./view_settings";

/** Formats that name no unit, and whose models come in many. */
const asked = /\.(stl|obj)\b/i;

/**
 * Returns whether the user is asked for the unit of a model: once for each folder and each dropped file, for STL and OBJ
 * files. Reads signals.
 */
export function asksForUnit({ folder, isUnitUnknown }: Pick<ViewSettings, "folder" | "isUnitUnknown">, { file }: Pick<DocumentState, "file">): boolean {
  const isFromFile = folder.value !== "" && folder.value !== "samples";
  return isUnitUnknown.value && isFromFile && asked.test(file);
}
