import type { EngineError } from "../protocol";
import { inSymmetryWords } from "./symmetry";

/** What the engine says in the words of the panels. */
export function inPanelWords(error: EngineError): EngineError {
  const remedy = error.remedy.replace(/(\b[Nn])ame another place/, (_, n: string) => `${n === "N" ? "D" : "d"}rag it to another place`);
  return inSymmetryWords({ ...error, location: locationWords(error.location), remedy });
}

/** "edit: steps[1].handles[0]" is what a file would call it; the panel counts from 1. */
export function locationWords(location: string): string {
  if (/^pose \d+$/.test(location)) return ""; // the one that is typed, or dragged
  const found = /^edit: steps\[(\d+)\]\.?(.*)$/.exec(location);
  if (found === null) return location.replace(/^edit: /, "");
  const [, step, rest = ""] = found;
  return `Step ${Number(step) + 1}${rest === "" ? "" : `, ${rest}`}`;
}
