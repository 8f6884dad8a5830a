// The plane at which a dropped part is cut open, as it is shown and dragged. No state, no screen.
import { Matrix4, Quaternion, Vector3 } from "three";

type Vector = readonly [number, number, number];

/** The plane in world coordinates, with what is needed to drag it. */
export interface BaseFrame {
  readonly centre: Vector3;
  /** Towards what is kept of the part, unit length. */
  readonly normal: Vector3;
  /** Within the plane, normal to the axis of the tilt: a larger tilt raises this side. Unit length. */
  readonly towardsTilt: Vector3;
  /** Half the side of the outline, in world units. */
  readonly radius: number;
  /** World units per unit of the part. */
  readonly scale: number;
  readonly height: number;
  readonly tiltDeg: number;
  /** The axis of the tilt, in the part's coordinates. */
  readonly tiltAxis: [number, number, number];
}

/** A plane as the engine reports it, in the part's coordinates. */
export interface ReportedBase {
  readonly height: number;
  readonly point: Vector;
  readonly normal: Vector;
}

const outlineRel = 0.3; // × the diagonal of the part
const mostTiltDeg = 60; // beyond, the plane hardly cuts the part
const leastHeightRel = 0.1; // × the height before

/** Returns the shown plane. `toWorld` is a similarity from the part's coordinates; `diagonal` is that of the part. */
export function baseFrame(
  { height, point, normal }: ReportedBase,
  asked: { readonly tilt_deg?: number | undefined; readonly tilt_axis?: readonly number[] | undefined },
  toWorld: Matrix4,
  diagonal: number,
): BaseFrame {
  const tiltDeg = asked.tilt_deg ?? 0;
  const own = new Vector3(...normal);
  const [x = 1, y = 0, z = 0] = asked.tilt_axis ?? usualAxis(own, tiltDeg);
  const axis = new Vector3(x, y, z).normalize();
  const scale = Math.cbrt(Math.abs(toWorld.determinant()));
  const direction = (of: Vector3) => of.clone().transformDirection(toWorld);
  return {
    centre: new Vector3(...point).applyMatrix4(toWorld),
    normal: direction(own),
    towardsTilt: direction(own.clone().cross(axis)),
    radius: outlineRel * diagonal * scale,
    scale,
    height,
    tiltDeg,
    tiltAxis: [x, y, z],
  };
}

/**
 * Returns the axis that a base is tilted about unless another one is given: x, or y where up is nearest to x. A normal
 * that is tilted already is turned back first; of two possible axes, that of the upright one that is nearer to a
 * coordinate axis is taken.
 */
function usualAxis(normal: Vector3, tiltDeg: number): Vector {
  const before = (axis: Vector3) => normal.clone().applyQuaternion(new Quaternion().setFromAxisAngle(axis, (-tiltDeg * Math.PI) / 180));
  const most = ({ x, y, z }: Vector3) => Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
  const alongX = before(new Vector3(0, 1, 0));
  const other = before(new Vector3(1, 0, 0));
  const isAlongX = Math.abs(alongX.x) > Math.max(Math.abs(alongX.y), Math.abs(alongX.z));
  return isAlongX && most(alongX) >= most(other) - 1e-9 ? [0, 1, 0] : [1, 0, 0];
}

/** Returns the corners of the outline: a square around the centre. */
export function baseCorners({ centre, normal, towardsTilt, radius }: BaseFrame): Vector3[] {
  const across = normal.clone().cross(towardsTilt);
  return [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([a = 0, b = 0]) =>
    centre.clone().addScaledVector(towardsTilt, a * radius).addScaledVector(across, b * radius),
  );
}

/** Returns the plane after it was dragged by a length along its normal, in world units. */
export function raised(frame: BaseFrame, by: number): BaseFrame {
  const { centre, normal, scale } = frame;
  const height = Number(Math.max(leastHeightRel * frame.height, frame.height + by / scale).toPrecision(4));
  return { ...frame, height, centre: centre.clone().addScaledVector(normal, (height - frame.height) * scale) };
}

/** Returns the plane after the grip at its rim was dragged by a length along the normal, in world units. */
export function tilted(frame: BaseFrame, by: number): BaseFrame {
  const { normal, towardsTilt, radius } = frame;
  const wanted = frame.tiltDeg + (Math.atan2(by, radius) * 180) / Math.PI;
  const tiltDeg = Math.round(Math.max(-mostTiltDeg, Math.min(mostTiltDeg, wanted)));
  const axis = towardsTilt.clone().cross(normal).normalize();
  const turn = new Quaternion().setFromAxisAngle(axis, ((tiltDeg - frame.tiltDeg) * Math.PI) / 180);
  return { ...frame, tiltDeg, normal: normal.clone().applyQuaternion(turn), towardsTilt: towardsTilt.clone().applyQuaternion(turn) };
}
