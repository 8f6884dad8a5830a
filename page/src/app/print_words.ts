import type { Outcome } from "../engine/connection";
import type { DocumentState, PageRequest } from "../protocol";
import { counted, formatNumber, formatSize, unitsOfFiles, type Unit } from "./units";

export type PrintCheck = NonNullable<Outcome["print"]>;
export type PrintFinding = NonNullable<Extract<PageRequest, { do: "mark" }>["print"]>;

/** The repairs that a line of the check can offer. */
export type PrintRemedy = "close-holes" | "split" | "turn";

/** One line of a print check. */
export interface PrintLine {
  /** `bad`: print shops refuse it; `warning`: it prints worse; `fact`: neither. */
  tone: "good" | "bad" | "warning" | "fact";
  words: string;
  finding?: PrintFinding;
  remedy?: PrintRemedy;
  /** What a user can do where there is no remedy by a click. */
  advice?: string;
}

/** The limits of the check. Lengths are in model units. */
export interface PrintLimits {
  leastWall: number;
  overhangDeg: number;
  unit: Unit;
}

/** Returns the lines of a print check: what is wrong with the surface, then its walls, overhangs and sizes. */
export function printLines(check: PrintCheck, limits: PrintLimits): PrintLine[] {
  return [
    closedLine(check),
    ...nonManifoldLines(check),
    facingLine(check),
    intersectionLine(check),
    ...wallLines(check, limits),
    overhangLine(check, limits),
    ...sizeLines(check, limits.unit),
  ];
}

/** Returns the lines that a user should know before the mesh is written for printing. */
export function printProblems(check: PrintCheck, limits: PrintLimits): PrintLine[] {
  return printLines(check, limits).filter(({ tone }) => tone === "bad" || tone === "warning");
}

function closedLine({ open_edges, holes }: PrintCheck): PrintLine {
  if (open_edges === 0) return { tone: "good", words: "Closed" };
  const words = holes > 0 ? `Open: ${counted(holes, "hole")}` : `Open: ${counted(open_edges, "edge")}`;
  return { tone: "bad", words, finding: "open-edges", remedy: "close-holes" };
}

function nonManifoldLines({ non_manifold_edges }: PrintCheck): PrintLine[] {
  if (non_manifold_edges === 0) return [];
  const words = `${counted(non_manifold_edges, "non-manifold edge")}, with more than two faces`;
  return [{ tone: "bad", words, finding: "non-manifold-edges", remedy: "split" }];
}

function facingLine({ turned_edges, inside_out }: PrintCheck): PrintLine {
  if (turned_edges > 0) {
    const words = counted(turned_edges, "edge between faces that face opposite ways", "edges between faces that face opposite ways");
    return { tone: "bad", words, finding: "turned-edges", remedy: "turn" };
  }
  if (inside_out) return { tone: "bad", words: "Inside out", remedy: "turn" };
  return { tone: "good", words: "All faces face the same way" };
}

function intersectionLine({ intersections }: PrintCheck): PrintLine {
  if (intersections === 0) return { tone: "good", words: "No self-intersections" };
  const words = `${counted(intersections, "self-intersecting pair")} of faces: print shops refuse this`;
  return { tone: "bad", words, finding: "intersections", advice: "Select the places that Show lights up, and Smooth them." };
}

function wallLines({ thinnest_wall }: PrintCheck, { leastWall, unit }: PrintLimits): PrintLine[] {
  if (thinnest_wall === null) return [];
  const words = `Thinnest wall ${lengthWords(thinnest_wall, unit)}`;
  if (thinnest_wall >= leastWall) return [{ tone: leastWall > 0 ? "good" : "fact", words, finding: "thin-walls" }];
  return [{ tone: "warning", words: `${words}, below ${lengthWords(leastWall, unit)}`, finding: "thin-walls" }];
}

function overhangLine({ overhanging, overhang_area, area }: PrintCheck, { overhangDeg }: PrintLimits): PrintLine {
  const angle = `${formatNumber(overhangDeg, 3)}°`;
  if (overhanging === 0) return { tone: "good", words: `No overhangs beyond ${angle}` };
  const share = formatNumber((100 * overhang_area) / area, 2);
  return { tone: "warning", words: `${share} % of the surface overhangs beyond ${angle}: it needs supports`, finding: "overhangs" };
}

function sizeLines({ size, volume }: PrintCheck, unit: Unit): PrintLine[] {
  const lines: PrintLine[] = [{ tone: "fact", words: `Size ${formatSize(size, unit)}` }];
  if (volume === null) return lines;
  return [...lines, { tone: "fact", words: `Volume ${formatNumber(volume, 4)}${unit === "none" ? "" : ` ${unit}³`}` }];
}

function lengthWords(length: number, unit: Unit): string {
  return formatSize([length], unit);
}

/** Returns a sentence on the unit of a file in a format, and a warning if it is not that of the view. */
export function unitOfFileWords(extension: string, fileUnit: DocumentState["unit"], shown: Unit): { words: string; isOther: boolean } {
  if (extension === ".3mf" || extension === ".glb" || extension === ".gltf") {
    const unit = extension === ".3mf" ? (fileUnit === "" ? "mm" : unitsOfFiles[fileUnit]) : "m";
    const isOther = shown !== "none" && shown !== unit;
    const words = isOther ? `The file says ${unit}, and the view shows ${shown}: scale the model first.` : `The file says ${unit}.`;
    return { words, isOther };
  }
  if (shown === "none") return { words: "The file names no unit. Printers take its numbers for mm.", isOther: false };
  const isOther = extension === ".stl" && shown !== "mm";
  const words = isOther
    ? `The file names no unit. Printers take its numbers for mm, and the view shows ${shown}: scale the model first.`
    : `The file names no unit; its numbers are ${shown}.`;
  return { words, isOther };
}
