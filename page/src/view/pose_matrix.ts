import { Matrix4, Quaternion, Vector3 } from "three";
import type { Pose } from "../protocol";

/**
 * Returns the matrix of x' = c + t + R S (x − c), as defined for edit files, or the pose's own matrix. Undefined for a
 * redrawn curve, which has no matrix.
 */
export function matrixOfPose(pose: Pose, pivot: readonly number[] = [0, 0, 0]): Matrix4 | undefined {
  if (pose.curve !== undefined || pose.def !== undefined) return undefined;
  if (pose.matrix !== undefined) {
    const [a, b, c, d] = pose.matrix.map((row) => [...row]);
    return new Matrix4().fromArray([...(a ?? []), ...(b ?? []), ...(c ?? []), ...(d ?? [])]).transpose();
  }
  const centre = new Vector3(...(pose.pivot ?? pivot));
  const turn = new Quaternion();
  if (pose.rotate !== undefined)
    turn.setFromAxisAngle(new Vector3(...pose.rotate.axis).normalize(), (pose.rotate.angle_deg * Math.PI) / 180);
  const scale = pose.scale ?? 1;
  const factors = typeof scale === "number" ? new Vector3(scale, scale, scale) : new Vector3(...scale);
  const moved = centre.clone().add(new Vector3(...(pose.translate ?? [0, 0, 0])));
  const back = new Matrix4().makeTranslation(-centre.x, -centre.y, -centre.z);
  return new Matrix4().compose(moved, turn, factors).multiply(back);
}
