import { Vector3 } from "three";
import { meetTriangles, type RayHit } from "./ray";
import type { Surface } from "./surface";

/** Finds what a ray meets, and what lies in a ball, of a surface as it is shown. */
export class PickTree {
  constructor(private readonly surface: Surface) {}

  /** In the surface's coordinates (relative to its offset). */
  raycast(origin: Vector3, direction: Vector3): RayHit | undefined {
    const { positions, triangles } = this.surface;
    return meetTriangles(positions, triangles, [origin.x, origin.y, origin.z], [direction.x, direction.y, direction.z]);
  }

  /** Triangles with a corner in the ball, or whose plane's nearest place in it is: each face is given once. */
  facesNear(centre: Vector3, radius: number, found: (face: number) => void): void {
    const { positions, triangles } = this.surface;
    for (let at = 0; at < triangles.length; at += 3)
      for (let k = 0; k < 3; ++k)
        if (isNear(positions, triangles[at + k] as number, centre, radius * radius)) {
          found(at / 3);
          break;
        }
  }

  dispose(): void {}
}

export function isNear(positions: Float32Array, v: number, centre: Vector3, radiusSquared: number): boolean {
  const x = (positions[3 * v] as number) - centre.x;
  const y = (positions[3 * v + 1] as number) - centre.y;
  const z = (positions[3 * v + 2] as number) - centre.z;
  return x * x + y * y + z * z <= radiusSquared;
}
