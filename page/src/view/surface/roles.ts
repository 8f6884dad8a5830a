/** Colours of regions, fixed parts and handles, components from 0 to 1. Handles take theirs in order. */
export const regionColour = [0.56, 0.74, 0.86] as const;
export const fixedColour = [0.42, 0.43, 0.46] as const;
const handleColours = [
  [0.9, 0.33, 0.31],
  [0.2, 0.62, 0.44],
  [0.45, 0.42, 0.85],
  [0.88, 0.65, 0.13],
  [0.78, 0.36, 0.7],
  [0.12, 0.6, 0.72],
  [0.6, 0.46, 0.28],
  [0.55, 0.72, 0.2],
] as const;

/** Returns the colour of a handle by its index in the step. */
export function handleColour(order: number): readonly [number, number, number] {
  return handleColours[order % handleColours.length] ?? handleColours[0];
}

/** Returns the strength of the tint of a region vertex, by its depth in the region (0 to 1). */
export function regionStrength(inside: number): number {
  return 0.75 * Math.min(1, 0.1 + 1.9 * inside);
}

/**
 * Returns the strength of the tint of a fixed vertex. It is 0 near the edge: there the two rings of triangles would
 * show as a ragged strip.
 */
export function fixedStrength(inside: number): number {
  return 0.25 * Math.min(1, 6 * Math.max(0, inside - 0.12));
}

/** Writes the premultiplied colour and its opacity into the 4 bytes of vertex v. */
export function writeTint(
  tint: Uint8Array,
  v: number,
  colour: readonly [number, number, number],
  strength: number,
): void {
  const a = 255 * strength;
  tint[4 * v] = a * colour[0];
  tint[4 * v + 1] = a * colour[1];
  tint[4 * v + 2] = a * colour[2];
  tint[4 * v + 3] = a;
}

/**
 * Computes the depth of each vertex in its region, from 0 at the edge to 1 at the deepest vertex. Depths are lengths
 * along edges, found by alternating sweeps over the triangles. Yields now and then. Returns one number for each of
 * `region`.
 */
export function* depthInRegion(
  positions: Float32Array,
  triangles: Uint32Array,
  region: Uint32Array,
): Generator<void, Float32Array> {
  const count = positions.length / 3;
  const depth = new Float32Array(count);
  for (const v of region) depth[v] = Infinity;
  const touching = [];
  for (let at = 0; at < triangles.length; at += 3) {
    const sum = depthAt(depth, triangles, at) + depthAt(depth, triangles, at + 1) + depthAt(depth, triangles, at + 2);
    if (sum > 0) touching.push(at);
    if (at % 196608 === 0) yield;
  }
  for (let sweep = 0; sweep < 24; ++sweep) {
    let changed = false;
    for (let i = 0; i < touching.length; ++i) {
      const at = touching[sweep % 2 === 0 ? i : touching.length - 1 - i] as number;
      for (let k = 0; k < 3; ++k)
        changed =
          relax(depth, positions, triangles[at + k] as number, triangles[at + ((k + 1) % 3)] as number) || changed;
      if (i % 65536 === 65535) yield;
    }
    if (!changed) break;
  }
  return relative(depth, region);
}

function depthAt(depth: Float32Array, triangles: Uint32Array, at: number): number {
  return depth[triangles[at] as number] as number;
}

function relax(depth: Float32Array, positions: Float32Array, a: number, b: number): boolean {
  const da = depth[a] as number;
  const db = depth[b] as number;
  if (da === db) return false;
  const x = (positions[3 * a] as number) - (positions[3 * b] as number);
  const y = (positions[3 * a + 1] as number) - (positions[3 * b + 1] as number);
  const z = (positions[3 * a + 2] as number) - (positions[3 * b + 2] as number);
  const length = Math.sqrt(x * x + y * y + z * z);
  const far = Math.min(da, db) + length;
  if (far >= Math.max(da, db)) return false;
  depth[da < db ? b : a] = far;
  return true;
}

function relative(depth: Float32Array, region: Uint32Array): Float32Array {
  let deepest = 0;
  for (const v of region) if ((depth[v] as number) < Infinity) deepest = Math.max(deepest, depth[v] as number);
  return Float32Array.from(region, (v) => {
    const d = depth[v] as number;
    return d < Infinity && deepest > 0 ? d / deepest : 1;
  });
}
