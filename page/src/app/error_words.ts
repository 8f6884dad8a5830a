import type { EngineError } from "../protocol";
import { inSymmetryWords } from "./symmetry";

/** Rewrites an error of the engine in the words of the panels. */
export function inPanelWords(error: EngineError): EngineError {
  const remedy = error.remedy.replace(/(\b[Nn])ame another place/, (_, n: string) => `${n === "N" ? "D" : "d"}rag it to another place`);
  return inSymmetryWords({ ...error, location: locationWords(error.location), remedy });
}

/** Rewrites a location of an edit file, such as "edit: steps[1].handles[0]", for the panels, which count from 1. */
export function locationWords(location: string): string {
  if (/^pose \d+$/.test(location)) return ""; // the pose being typed or dragged needs no location
  const found = /^edit: steps\[(\d+)\]\.?(.*)$/.exec(location);
  if (found === null) return location.replace(/^edit: /, "");
  const [, step, rest = ""] = found;
  return `Step ${Number(step) + 1}${rest === "" ? "" : `, ${rest}`}`;
}
