// A cutting plane, and what gestures make of it. No state, no screen.
import { Vector3 } from "three";

/** The points x with (x - point) · normal = 0; `normal` has length 1 and points above. */
export interface CutPlane {
  readonly point: Vector3;
  readonly normal: Vector3;
}

/**
 * The plane through a line that is drawn across the view: through the places a and b on the page, and along the
 * direction of view there. Above lies at the left hand of the line. Undefined for a line without length.
 */
export function planeThroughLine(a: Vector3, b: Vector3, alongA: Vector3, alongB: Vector3): CutPlane | undefined {
  const along = alongA.clone().normalize().add(alongB.clone().normalize());
  const line = b.clone().sub(a);
  const normal = along.clone().cross(line);
  if (!(normal.lengthSq() > 1e-24 * along.lengthSq() * Math.max(1e-12, line.lengthSq()))) return undefined;
  return { point: a.clone().add(b).multiplyScalar(0.5), normal: normal.normalize().negate() };
}

/** Moved along its normal. */
export function movedBy(plane: CutPlane, length: number): CutPlane {
  return { point: plane.point.clone().addScaledVector(plane.normal, length), normal: plane.normal };
}

/** Tilted so that its normal points to `tip` from where it is. */
export function tiltedTo(plane: CutPlane, tip: Vector3): CutPlane {
  const normal = tip.clone().sub(plane.point);
  return normal.lengthSq() > 0 ? { point: plane.point, normal: normal.normalize() } : plane;
}

export function flipped({ point, normal }: CutPlane): CutPlane {
  return { point, normal: normal.clone().negate() };
}

/** How far along a line a ray passes it by nearest; undefined where the two are parallel. */
export function nearestAlong(point: Vector3, direction: Vector3, rayOrigin: Vector3, rayDirection: Vector3): number | undefined {
  const d = direction.clone().normalize();
  const r = rayDirection.clone().normalize();
  const cosine = d.dot(r);
  const sine2 = 1 - cosine * cosine;
  if (sine2 < 1e-8) return undefined;
  const between = rayOrigin.clone().sub(point);
  return (between.dot(d) - cosine * between.dot(r)) / sine2;
}

/** Where a ray meets a ball, or else passes it by nearest, as a place on the ball. */
export function onBall(centre: Vector3, radius: number, rayOrigin: Vector3, rayDirection: Vector3): Vector3 {
  const r = rayDirection.clone().normalize();
  const towards = centre.clone().sub(rayOrigin);
  const middle = towards.dot(r);
  const off2 = towards.lengthSq() - middle * middle;
  const half = Math.sqrt(Math.max(0, radius * radius - off2));
  const place = rayOrigin.clone().addScaledVector(r, middle - half).sub(centre);
  return place.setLength(radius).add(centre);
}

/** Whether a closed polygon on the page (y down) runs counter-clockwise as it is seen: its inside is at its left hand. */
export function runsLeft(polygon: readonly (readonly [number, number])[]): boolean {
  let twice = 0;
  polygon.forEach(([x, y], i) => {
    const [u, v] = polygon[(i + 1) % polygon.length] ?? [x, y];
    twice += x * v - u * y;
  });
  return twice < 0;
}
