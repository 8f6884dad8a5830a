import { Quaternion, Vector3 } from "three";
import type { Pose, Vector } from "../protocol";
import type { Box } from "./editor";

/** Returns the pose that scales a model by a factor, so that the middle of its foot stays where it is. */
export function scalingPose(factor: number, { low, high }: Box, up: Vector): Pose {
  const pivot = low.map((least, k) => ((high[k] ?? 0) + least) / 2) as Vector;
  const axis = up.findIndex((along) => along !== 0);
  pivot[axis] = low[axis] ?? 0;
  return { scale: factor, pivot };
}

/**
 * Returns the pose that turns a model so that a face with this outward normal looks down, and then lifts it onto the
 * bed, at height 0. `positions`: 3 numbers a vertex, relative to `offset`.
 */
export function layingPose(normal: Vector3, upward: Vector3, positions: Float32Array, offset: readonly number[]): Pose {
  const up = upward.clone().normalize();
  const turn = new Quaternion().setFromUnitVectors(normal.clone().normalize(), up.clone().negate());
  const pivot = new Vector3(...(offset as Vector));
  const lowest = lowestAfter(turn, up, positions) + pivot.dot(up);
  const { axis, angleDeg } = axisAngleOf(turn);
  const shift = up.multiplyScalar(-lowest);
  return {
    translate: shift.toArray(),
    ...(angleDeg === 0 ? {} : { rotate: { axis: axis.toArray(), angle_deg: angleDeg } }),
    pivot: pivot.toArray(),
  };
}

/** Returns the smallest height of positions after a turn about their origin. */
function lowestAfter(turn: Quaternion, up: Vector3, positions: Float32Array): number {
  const before = up.clone().applyQuaternion(turn.clone().invert()); // the direction that becomes up
  let lowest = Infinity;
  for (let at = 0; at + 2 < positions.length; at += 3) {
    const height =
      before.x * (positions[at] as number) + before.y * (positions[at + 1] as number) + before.z * (positions[at + 2] as number);
    if (height < lowest) lowest = height;
  }
  return Number.isFinite(lowest) ? lowest : 0;
}

function axisAngleOf({ x, y, z, w }: Quaternion): { axis: Vector3; angleDeg: number } {
  const axis = new Vector3(x, y, z);
  const sine = axis.length();
  if (sine < 1e-9) return { axis: new Vector3(0, 0, 1), angleDeg: 0 };
  return { axis: axis.divideScalar(sine), angleDeg: (2 * Math.atan2(sine, w) * 180) / Math.PI };
}
