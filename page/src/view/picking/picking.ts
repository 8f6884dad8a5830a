import { Vector3, type Ray } from "three";
import { isNear, type PickTree } from "./pick_tree";
import { PolygonTest, type Polygon } from "./polygon";
import type { Surface } from "../surface/surface";

/** The point of a surface under the pointer. */
export interface Hit {
  surface: Surface;
  point: Vector3; // world coordinates, on the surface as shown
  normal: Vector3; // unit normal of the triangle, in the world
  face: number;
  vertex: number; // the corner of the face nearest to the point
  facing: boolean; // whether the triangle's outside faces the camera
}

/** Returns the nearest triangle of the shown surface that a world ray meets. */
export function raycastSurface(surface: Surface, tree: PickTree, ray: Ray): (Hit & { distance: number }) | undefined {
  const origin = ray.origin.clone().sub(surface.object.position);
  const met = tree.raycast(origin, ray.direction);
  if (met === undefined) return undefined;
  const corners = [0, 1, 2].map((k) => surface.triangles[3 * met.face + k] as number);
  const [a, b, c] = corners.map((v) => surface.positionOf(v)) as [Vector3, Vector3, Vector3];
  const point = ray.at(met.distance, new Vector3());
  const normal = new Vector3().crossVectors(b.clone().sub(a), c.clone().sub(a)).normalize();
  const distances = [a, b, c].map((corner) => corner.distanceToSquared(point));
  const vertex = corners[distances.indexOf(Math.min(...distances))] as number;
  const facing = normal.dot(ray.direction) < 0;
  return { surface, point, normal, face: met.face, vertex, facing, distance: met.distance };
}

/** Maps points to pixels of the page: a 4×4 matrix in column-major order, then the canvas's box. */
export interface ClipTransform {
  matrix: ArrayLike<number>; // projection × view × translation of the surface
  box: DOMRect;
}

/** Returns the vertices whose projection is inside a polygon (pixels of the page), ascending. */
export function verticesInPolygon(surface: Surface, { matrix, box }: ClipTransform, polygon: Polygon): Uint32Array {
  const test = new PolygonTest(polygon);
  const p = surface.positions;
  const found: number[] = [];
  const [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = Array.from(matrix) as SixteenNumbers;
  for (let v = 0; v < surface.vertexCount; ++v) {
    const x = p[3 * v] as number;
    const y = p[3 * v + 1] as number;
    const z = p[3 * v + 2] as number;
    const w = m3 * x + m7 * y + m11 * z + m15;
    if (!(w > 0)) continue;
    const across = (m0 * x + m4 * y + m8 * z + m12) / w;
    const up = (m1 * x + m5 * y + m9 * z + m13) / w;
    if (test.contains(box.left + 0.5 * (across + 1) * box.width, box.top + 0.5 * (1 - up) * box.height)) found.push(v);
  }
  return Uint32Array.from(found);
}

type Four = [number, number, number, number];
type SixteenNumbers = [...Four, ...Four, ...Four, ...Four];

/**
 * Returns the vertices in a ball around a hit, ascending. Without `through`: only those connected to the hit by
 * triangles that face the camera.
 */
export function verticesNear(
  hit: Hit,
  tree: PickTree,
  radius: number,
  through: boolean,
  cameraPosition: Vector3,
): Uint32Array {
  const { surface } = hit;
  const centre = hit.point.clone().sub(surface.object.position);
  const groups = new DisjointSets();
  const inside = new Set<number>();
  const square = radius * radius;
  const ownCameraPosition = cameraPosition.clone().sub(surface.object.position);
  tree.facesNear(centre, radius, (face) => {
    if (!through && !facesCamera(surface, face, ownCameraPosition, hit.facing)) return;
    let first = -1;
    for (let k = 0; k < 3; ++k) {
      const v = surface.triangles[3 * face + k] as number;
      if (!isNear(surface.positions, v, centre, square)) continue;
      inside.add(v);
      if (first >= 0) groups.join(first, v);
      first = v;
    }
  });
  const start = groups.of(hit.vertex);
  const near = [...inside].filter((v) => through || groups.of(v) === start);
  return Uint32Array.from(near.length > 0 ? near : [hit.vertex]).sort();
}

function facesCamera(surface: Surface, face: number, cameraPosition: Vector3, front: boolean): boolean {
  const p = surface.positions;
  const [a, b, c] = [0, 1, 2].map((k) => 3 * (surface.triangles[3 * face + k] as number)) as [number, number, number];
  const corner = new Vector3().fromArray(p, a);
  const u = new Vector3().fromArray(p, b).sub(corner);
  const v = new Vector3().fromArray(p, c).sub(corner);
  return u.cross(v).dot(corner.sub(cameraPosition)) < 0 === front;
}

/** Disjoint sets of numbers (union–find). */
class DisjointSets {
  private readonly parent = new Map<number, number>();
  of(a: number): number {
    let root = a;
    for (let up = this.parent.get(root); up !== undefined; up = this.parent.get(root)) root = up;
    if (root !== a) this.parent.set(a, root);
    return root;
  }
  join(a: number, b: number): void {
    const ra = this.of(a);
    const rb = this.of(b);
    if (ra !== rb) this.parent.set(ra, rb);
  }
}
