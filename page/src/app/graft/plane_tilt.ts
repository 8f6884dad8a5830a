import type { Vector3Tuple } from "./graft_step";

export const axisNames = ["X", "Y", "Z"] as const;

/** A plane's normal as angles by which an axis leans towards the two that follow it. */
export interface PlaneTilt {
  readonly axis: 0 | 1 | 2;
  /** Whether the normal looks along the axis, and not against it. */
  readonly isAlong: boolean;
  readonly degrees: readonly [number, number];
}

/** The largest angle of a tilt towards one axis. */
export const mostPlaneTiltDeg = 80;

const radian = Math.PI / 180;

/** Returns the tilt of a normal from `axis`, or from the axis nearest to it if it leans farther than `mostPlaneTiltDeg`. */
export function tiltOf(normal: Vector3Tuple, axis: 0 | 1 | 2): PlaneTilt {
  const from = (k: 0 | 1 | 2): PlaneTilt => {
    const along = Math.abs(normal[k]);
    const angle = (by: number) => Math.atan2(normal[(k + by) % 3] as number, along) / radian;
    return { axis: k, isAlong: normal[k] >= 0, degrees: [angle(1), angle(2)] };
  };
  const tilt = from(axis);
  if (tilt.degrees.every((angle) => Math.abs(angle) <= mostPlaneTiltDeg + 1e-6)) return tilt;
  const sizes = normal.map(Math.abs);
  return from(sizes.indexOf(Math.max(...sizes)) as 0 | 1 | 2);
}

/** Returns the unit normal of a tilt. */
export function normalOfTilt({ axis, isAlong, degrees }: PlaneTilt): Vector3Tuple {
  const normal: Vector3Tuple = [0, 0, 0];
  normal[axis] = isAlong ? 1 : -1;
  degrees.forEach((angle, k) => (normal[(axis + k + 1) % 3] = Math.tan(angle * radian)));
  const length = Math.hypot(...normal);
  return normal.map((x) => x / length) as Vector3Tuple;
}
