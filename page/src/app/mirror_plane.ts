import type { Vector } from "../protocol";
import type { Box } from "./editor";
import { nameOfAxis, axisOf } from "./handle_pose";

export interface Plane {
  point: Vector;
  normal: Vector;
}
export type PlaneAxis = "x" | "y" | "z";

/** The axis that a plane lies across, in either direction; undefined where it is slanted. */
export function axisOfPlane({ normal }: Plane): PlaneAxis | undefined {
  const name = nameOfAxis([Math.abs(normal[0]), Math.abs(normal[1]), Math.abs(normal[2])]);
  return name === "free" ? undefined : name;
}

const indices = { x: 0, y: 1, z: 2 } as const;

/** Where a plane across an axis meets it. */
export function placeOf(plane: Plane, axis: PlaneAxis): number {
  return plane.point[indices[axis]];
}

/** A plane across an axis; without a place, through the middle of the box. */
export function planeAcross(axis: PlaneAxis, box: Box, place?: number): Plane {
  const point: Vector = [0, 1, 2].map((k) => ((box.low[k] as number) + (box.high[k] as number)) / 2) as Vector;
  if (place !== undefined) point[indices[axis]] = place;
  return { point, normal: axisOf(axis) };
}

/** How far a place on the axis may sensibly go. */
export function rangeAlong(axis: PlaneAxis, { low, high }: Box): [number, number] {
  return [low[indices[axis]], high[indices[axis]]];
}
