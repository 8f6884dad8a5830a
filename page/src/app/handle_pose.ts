import type { Pose, Vector } from "../protocol";

/** A pose as numbers to type, with defaults for the missing fields. */
export interface PoseNumbers {
  translate: Vector;
  axis: Vector;
  angleDeg: number;
  scale: Vector;
  pivot: Vector;
}

/** Returns the numbers of a pose; undefined for a matrix or a redrawn curve, which have none. */
export function numbersOf(pose: Pose, pivot: Vector): PoseNumbers | undefined {
  if (pose.matrix !== undefined || pose.curve !== undefined || pose.def !== undefined) return undefined;
  const { scale = 1 } = pose;
  return {
    translate: pose.translate ?? [0, 0, 0],
    axis: pose.rotate?.axis ?? [0, 0, 1],
    angleDeg: pose.rotate?.angle_deg ?? 0,
    scale: typeof scale === "number" ? [scale, scale, scale] : scale,
    pivot: pose.pivot ?? pivot,
  };
}

/**
 * Returns `pose` with other numbers. Fields without effect are left out, and the pivot is kept only if it was given.
 */
export function withNumbers(pose: Pose, changes: Partial<PoseNumbers>): Pose {
  const next: Pose = { ...pose };
  if (changes.translate !== undefined) next.translate = changes.translate;
  if (changes.pivot !== undefined) next.pivot = changes.pivot;
  if (changes.axis !== undefined || changes.angleDeg !== undefined)
    next.rotate = {
      axis: changes.axis ?? pose.rotate?.axis ?? [0, 0, 1],
      angle_deg: changes.angleDeg ?? pose.rotate?.angle_deg ?? 0,
    };
  if (changes.scale !== undefined) next.scale = isUniform(changes.scale) ? changes.scale[0] : changes.scale;
  if (next.translate?.every((t) => t === 0) === true) delete next.translate;
  if (next.rotate?.angle_deg === 0) delete next.rotate;
  if (next.scale === 1) delete next.scale;
  return next;
}

export function isUniform([x, y, z]: Vector): boolean {
  return x === y && y === z;
}

export function isAtRest(pose: Pose): boolean {
  const { pivot: _, ...motion } = pose;
  return Object.keys(motion).length === 0;
}

export type AxisName = "x" | "y" | "z" | "free";

/** Returns the name of the axis that a vector of any length points along; -x is `free`. */
export function nameOfAxis(axis: Vector): AxisName {
  const names: AxisName[] = ["x", "y", "z"];
  const only = axis.filter((a) => a !== 0).length === 1 ? axis.findIndex((a) => a > 0) : -1;
  return names[only] ?? "free";
}

export function axisOf(name: Exclude<AxisName, "free">): Vector {
  return [name === "x" ? 1 : 0, name === "y" ? 1 : 0, name === "z" ? 1 : 0];
}

export function withComponent(vector: Vector, k: 0 | 1 | 2, value: number): Vector {
  const next: Vector = [...vector];
  next[k] = value;
  return next;
}
