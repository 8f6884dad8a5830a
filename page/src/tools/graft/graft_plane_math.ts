// The cutting plane of a gesture. No state, no screen.
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
