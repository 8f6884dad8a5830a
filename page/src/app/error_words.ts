import type { EngineError } from "../protocol";
import { inSymmetryWords } from "./symmetry";

/** What the engine says in the words of the panels. */
export function inPanelWords(error: EngineError): EngineError {
  return inSymmetryWords({ ...error, place: placeWords(error.place) });
}

/** "edit: steps[1].handles[0]" is what a file would call it; the panel counts from 1. */
export function placeWords(place: string): string {
  const found = /^edit: steps\[(\d+)\]\.?(.*)$/.exec(place);
  if (found === null) return place.replace(/^edit: /, "");
  const [, step, rest = ""] = found;
  return `Step ${Number(step) + 1}${rest === "" ? "" : `, ${rest}`}`;
}
