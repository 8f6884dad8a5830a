/** A hit of a ray found by testing every triangle. Used while a mesh has no bounding-volume tree. */
export interface RayHit {
  face: number;
  distance: number; // in multiples of the direction's length
}

type Triple = readonly [number, number, number];

/**
 * Returns the nearest triangle that the ray meets from either side. `triangles`: 3 indices each; `positions`: 3 numbers
 * each.
 */
export function raycastTriangles(
  positions: Float32Array,
  triangles: Uint32Array,
  origin: Triple,
  direction: Triple,
): RayHit | undefined {
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let face = -1;
  let nearest = Infinity;
  for (let at = 0; at < triangles.length; at += 3) {
    const a = 3 * (triangles[at] as number);
    const b = 3 * (triangles[at + 1] as number);
    const c = 3 * (triangles[at + 2] as number);
    const ax = positions[a] as number;
    const ay = positions[a + 1] as number;
    const az = positions[a + 2] as number;
    const ux = (positions[b] as number) - ax;
    const uy = (positions[b + 1] as number) - ay;
    const uz = (positions[b + 2] as number) - az;
    const vx = (positions[c] as number) - ax;
    const vy = (positions[c + 1] as number) - ay;
    const vz = (positions[c + 2] as number) - az;
    const px = dy * vz - dz * vy;
    const py = dz * vx - dx * vz;
    const pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det === 0) continue;
    const sx = ox - ax;
    const sy = oy - ay;
    const sz = oz - az;
    const s = (sx * px + sy * py + sz * pz) / det;
    if (!(s >= 0 && s <= 1)) continue;
    const qx = sy * uz - sz * uy;
    const qy = sz * ux - sx * uz;
    const qz = sx * uy - sy * ux;
    const t = (dx * qx + dy * qy + dz * qz) / det;
    if (!(t >= 0 && s + t <= 1)) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / det;
    if (distance > 0 && distance < nearest) {
      nearest = distance;
      face = at / 3;
    }
  }
  return face < 0 ? undefined : { face, distance: nearest };
}
