import type { Vector } from "../protocol";
import type { Box } from "./editor";
import { nameOfAxis, axisOf } from "./handle_pose";

export interface Plane {
  point: Vector;
  normal: Vector;
}
export type PlaneAxis = "x" | "y" | "z";

/** Returns the axis that is normal to a plane, in either direction; undefined for a slanted plane. */
export function axisOfPlane({ normal }: Plane): PlaneAxis | undefined {
  const name = nameOfAxis([Math.abs(normal[0]), Math.abs(normal[1]), Math.abs(normal[2])]);
  return name === "free" ? undefined : name;
}

const indices = { x: 0, y: 1, z: 2 } as const;

/** Returns the coordinate at which a plane normal to an axis meets that axis. */
export function coordinateOf(plane: Plane, axis: PlaneAxis): number {
  return plane.point[indices[axis]];
}

/** Returns the axis that a direction is nearest to. */
export function nearestAxis(direction: readonly number[]): PlaneAxis {
  const [x = 0, y = 0, z = 0] = direction.map(Math.abs);
  return x >= Math.max(y, z) ? "x" : y >= z ? "y" : "z";
}

/** Returns the plane normal to an axis at a coordinate; without one, through the centre of the box. */
export function planeAcross(axis: PlaneAxis, box: Box, coordinate?: number): Plane {
  const point: Vector = [0, 1, 2].map((k) => ((box.low[k] as number) + (box.high[k] as number)) / 2) as Vector;
  if (coordinate !== undefined) point[indices[axis]] = coordinate;
  return { point, normal: axisOf(axis) };
}

/** Returns the sensible range of the plane's coordinate: the extent of the box along the axis. */
export function rangeAlong(axis: PlaneAxis, { low, high }: Box): [number, number] {
  return [low[indices[axis]], high[indices[axis]]];
}
