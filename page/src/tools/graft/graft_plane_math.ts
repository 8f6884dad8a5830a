// A cutting plane, and how gestures change it. No state, no screen.
import { Vector3 } from "three";

/** The points x with (x - point) · normal = 0. `normal` has length 1 and points to the side above. */
export interface CutPlane {
  readonly point: Vector3;
  readonly normal: Vector3;
}

/**
 * Returns the plane through a line drawn on the screen and along the viewing direction. The line goes from a to b,
 * points of the world with viewing directions `alongA` and `alongB`. Above is at the left of the line. Undefined for a
 * line without length.
 */
export function planeThroughLine(a: Vector3, b: Vector3, alongA: Vector3, alongB: Vector3): CutPlane | undefined {
  const along = alongA.clone().normalize().add(alongB.clone().normalize());
  const line = b.clone().sub(a);
  const normal = along.clone().cross(line);
  if (!(normal.lengthSq() > 1e-24 * along.lengthSq() * Math.max(1e-12, line.lengthSq()))) return undefined;
  return { point: a.clone().add(b).multiplyScalar(0.5), normal: normal.normalize().negate() };
}

/** Returns the plane moved along its normal. */
export function movedBy(plane: CutPlane, length: number): CutPlane {
  return { point: plane.point.clone().addScaledVector(plane.normal, length), normal: plane.normal };
}

/** Returns the plane tilted so that its normal points from its point to `tip`. */
export function tiltedTo(plane: CutPlane, tip: Vector3): CutPlane {
  const normal = tip.clone().sub(plane.point);
  return normal.lengthSq() > 0 ? { point: plane.point, normal: normal.normalize() } : plane;
}

export function flipped({ point, normal }: CutPlane): CutPlane {
  return { point, normal: normal.clone().negate() };
}

/** Returns the parameter of the point of a line that is nearest to a ray; undefined if the two are parallel. */
export function nearestAlong(point: Vector3, direction: Vector3, rayOrigin: Vector3, rayDirection: Vector3): number | undefined {
  const d = direction.clone().normalize();
  const r = rayDirection.clone().normalize();
  const cosine = d.dot(r);
  const sine2 = 1 - cosine * cosine;
  if (sine2 < 1e-8) return undefined;
  const between = rayOrigin.clone().sub(point);
  return (between.dot(d) - cosine * between.dot(r)) / sine2;
}

/** Returns the point where a ray meets a sphere, or else the point of the sphere nearest to the ray. */
export function onBall(centre: Vector3, radius: number, rayOrigin: Vector3, rayDirection: Vector3): Vector3 {
  const r = rayDirection.clone().normalize();
  const towards = centre.clone().sub(rayOrigin);
  const middle = towards.dot(r);
  const off2 = towards.lengthSq() - middle * middle;
  const half = Math.sqrt(Math.max(0, radius * radius - off2));
  const point = rayOrigin.clone().addScaledVector(r, middle - half).sub(centre);
  return point.setLength(radius).add(centre);
}

/**
 * Returns whether a closed polygon on the page (y down) appears counter-clockwise, so that its inside is at its left.
 */
export function runsLeft(polygon: readonly (readonly [number, number])[]): boolean {
  let twice = 0;
  polygon.forEach(([x, y], i) => {
    const [u, v] = polygon[(i + 1) % polygon.length] ?? [x, y];
    twice += x * v - u * y;
  });
  return twice < 0;
}
