// Cuts of a mesh: along what, how they are closed, and what is kept.
import type { DocumentState, PageRequest, Plane } from "../protocol";

type Step = DocumentState["steps"][number];

export type CutRequest = Extract<PageRequest, { do: "cut" }>;
/** What a cut keeps: one side, or both as two objects. */
export type Side = "above" | "below" | "both";

/** A plane to cut a mesh by, in the coordinates of that mesh. */
export interface Cut {
  readonly mesh: number;
  readonly plane: Plane;
}

/** A curve being drawn to cut along, through these vertices of a mesh. */
export interface DrawnCurve {
  readonly mesh: number;
  readonly vertices: readonly number[];
  readonly closed: boolean;
}

/** Sizes of pins, in model units; those left out follow from the size of the cut. */
export interface Pins {
  readonly count?: number;
  readonly diameter?: number;
  readonly length?: number;
  readonly clearance?: number;
  readonly side?: "above" | "below";
}

/** How a cut by a plane is closed: not at all, flat, or with pins and holes. */
export interface CutClosing {
  readonly cap: "open" | "flat" | "pins";
  readonly pins?: Pins;
}

/** Returns the fields of a cut that is closed so. */
export function closingFields({ cap, pins }: CutClosing): { cap?: "flat"; pins?: Pins } {
  return cap === "open" ? {} : cap === "flat" ? { cap } : { pins: pins ?? {} };
}

/** Returns how a cut step is closed, by its fields. */
export function closingOf(fields: { readonly cap?: string; readonly pins?: Pins }): CutClosing {
  return fields.pins !== undefined ? { cap: "pins", pins: fields.pins } : { cap: fields.cap === "flat" ? "flat" : "open" };
}

/** Returns the fields of a request to keep that side. */
export function keptFields(side: Side): Pick<CutRequest, "keep" | "halves"> {
  return side === "both" ? { halves: true } : { keep: side };
}

/** Returns the cut of the other side; undefined where both are kept. */
export function otherSide(cut: CutRequest): CutRequest | undefined {
  if (cut.keep !== "above" && cut.keep !== "below") return undefined;
  return { ...cut, keep: cut.keep === "above" ? "below" : "above" };
}

const fieldsOfBothHalves = ["mesh", "plane", "loop", "snap", "cap", "pins"];

/** Returns whether a step is one of the two cuts that divide an object, which keep a side each. */
export function isHalf(steps: readonly Pick<Step, "kind" | "fields">[], index: number): boolean {
  const step = steps[index];
  return step !== undefined && [steps[index - 1], steps[index + 1]].some((other) => other !== undefined && areHalves(step, other));
}

function areHalves(one: Pick<Step, "kind" | "fields">, other: Pick<Step, "kind" | "fields">): boolean {
  const [a, b] = [one.fields, other.fields] as Record<string, unknown>[];
  if (one.kind !== "cut" || other.kind !== "cut" || a === undefined || b === undefined) return false;
  const isAlike = (field: string) => JSON.stringify(a[field]) === JSON.stringify(b[field]);
  return [a["keep"], b["keep"]].sort().join() === "above,below" && fieldsOfBothHalves.every(isAlike);
}
