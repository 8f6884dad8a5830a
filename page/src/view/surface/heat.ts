import { DataTexture, LinearFilter, Triangle, Vector3 } from "three";
import type { HeatMap } from "../../app/view_settings";
import { colourTable, cssGradient, diverging, rising, type ColourMap } from "./colour_maps";

/** The meaning of a heat map's colours, for a legend beside the view. */
export interface Legend {
  title: string;
  min: number;
  max: number;
  format: (value: number) => string;
  gradient: string; // CSS, from left to right
}

export type StretchOf = "area" | "edges";

const textures = new Map<ColourMap, DataTexture>();

/** Returns the colours of a heat map, 256 texels. */
export function heatTexture(map: HeatMap): DataTexture {
  const colours = map === "stretch" ? diverging : rising;
  const known = textures.get(colours);
  if (known !== undefined) return known;
  const texture = new DataTexture(colourTable(colours, 256), 256, 1);
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  textures.set(colours, texture);
  return texture;
}

/** Returns the range up to the 98th percentile. It is symmetric about 0 for `stretch`, and otherwise begins at 0. */
export function heatRange(map: HeatMap, values: Float32Array): [number, number] {
  const every = Math.max(1, Math.floor(values.length / 20000));
  const sample = values.filter((value, i) => i % every === 0 && Number.isFinite(value));
  if (map === "stretch") {
    const sizes = sample.map(Math.abs).sort();
    return evenly(Math.max(0.05, sizes[Math.floor(0.98 * (sizes.length - 1))] ?? 0));
  }
  const sorted = (map === "seam" ? sample.filter((bend) => bend > 0) : sample).sort();
  return [0, sorted[Math.floor(0.98 * (sorted.length - 1))] || 1];
}

function evenly(size: number): [number, number] {
  return [-size, size];
}

export function legendOf(map: HeatMap, of: StretchOf, [min, max]: [number, number]): Legend {
  const gradient = cssGradient(map === "stretch" ? diverging : rising);
  if (map === "stretch") {
    const title = of === "area" ? "Change of area" : "Change of edge lengths";
    return { title, min, max, gradient, format: (value) => `×${(2 ** value).toPrecision(3)}` };
  }
  if (map === "seam")
    return { title: "Bend angle at the seam", min, max, gradient, format: (value) => `${value.toPrecision(2)}°` };
  const title = "Detail: distance from the neighbours' mean";
  return { title, min, max, gradient, format: (value) => value.toPrecision(3) };
}

/**
 * Computes the stretch around each vertex relative to rest, as a power of 2. It compares the area of the triangles
 * around the vertex or the lengths of their edges. Triangles without a rest shape (NaN) do not count. Yields now and then.
 */
export function* stretchOf(
  of: StretchOf,
  rest: Float32Array,
  shown: Float32Array,
  triangles: Uint32Array,
): Generator<void, Float32Array> {
  const before = new Float32Array(rest.length / 3);
  const after = new Float32Array(rest.length / 3);
  const measure = of === "area" ? areaOf : lengthsOf;
  for (let at = 0; at < triangles.length; at += 3) {
    const a = triangles[at] as number;
    const b = triangles[at + 1] as number;
    const c = triangles[at + 2] as number;
    const was = measure(rest, 3 * a, 3 * b, 3 * c);
    if (Number.isNaN(was)) continue;
    const is = measure(shown, 3 * a, 3 * b, 3 * c);
    for (const v of [a, b, c]) {
      before[v] = (before[v] as number) + was;
      after[v] = (after[v] as number) + is;
    }
    if (at % 98304 === 0) yield;
  }
  return before.map((was, v) => (was > 0 && (after[v] as number) > 0 ? Math.log2((after[v] as number) / was) : 0));
}

/**
 * Computes ‖δ‖: the distance of each vertex from the mean of its ring. Edges: two vertices each. Yields now and then.
 */
export function* detailOf(p: Float32Array, edges: Uint32Array): Generator<void, Float32Array> {
  const sums = new Float32Array(p.length);
  const counts = new Uint16Array(p.length / 3);
  for (let at = 0; at < edges.length; at += 2) {
    const a = edges[at] as number;
    const b = edges[at + 1] as number;
    // Sums of differences keep small values accurate in single precision.
    for (let k = 0; k < 3; ++k) {
      const difference = (p[3 * b + k] as number) - (p[3 * a + k] as number);
      sums[3 * a + k] = (sums[3 * a + k] as number) + difference;
      sums[3 * b + k] = (sums[3 * b + k] as number) - difference;
    }
    counts[a] = (counts[a] as number) + 1;
    counts[b] = (counts[b] as number) + 1;
    if (at % 131072 === 0) yield;
  }
  return Float32Array.from(counts, (count, v) =>
    count === 0 ? 0 : Math.hypot(sums[3 * v] as number, sums[3 * v + 1] as number, sums[3 * v + 2] as number) / count,
  );
}

/**
 * Computes the bend at each seam vertex: the largest angle between the normals of the two triangles at one of its
 * edges, in degrees. It is 0 elsewhere.
 */
export function bendsOf(p: Float32Array, triangles: Uint32Array, seam: Uint32Array): Float32Array {
  const isSeam = new Uint8Array(p.length / 3);
  for (const v of seam) isSeam[v] = 1;
  const bends = new Float32Array(p.length / 3);
  const met = new Map<number, Vector3>(); // per edge: normal of the last triangle met at it
  const corners = [new Vector3(), new Vector3(), new Vector3()] as const;
  for (let at = 0; at < triangles.length; at += 3) {
    const ids = [triangles[at], triangles[at + 1], triangles[at + 2]] as [number, number, number];
    if (ids.every((v) => isSeam[v] === 0)) continue;
    ids.forEach((v, k) => corners[k]?.fromArray(p, 3 * v));
    const normal = new Triangle(...corners).getNormal(new Vector3());
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [ids[k] as number, ids[(k + 1) % 3] as number];
      const edge = Math.min(a, b) * bends.length + Math.max(a, b);
      const other = met.get(edge);
      met.set(edge, normal);
      if (other === undefined) continue;
      const bend = (other.angleTo(normal) * 180) / Math.PI;
      for (const v of [a, b]) if (isSeam[v] === 1) bends[v] = Math.max(bends[v] as number, bend);
    }
  }
  return bends;
}

function distance(p: Float32Array, a: number, b: number): number {
  const x = (p[a] as number) - (p[b] as number);
  const y = (p[a + 1] as number) - (p[b + 1] as number);
  const z = (p[a + 2] as number) - (p[b + 2] as number);
  return Math.sqrt(x * x + y * y + z * z);
}

function lengthsOf(p: Float32Array, a: number, b: number, c: number): number {
  return distance(p, a, b) + distance(p, b, c) + distance(p, c, a);
}

function areaOf(p: Float32Array, a: number, b: number, c: number): number {
  const ux = (p[b] as number) - (p[a] as number);
  const uy = (p[b + 1] as number) - (p[a + 1] as number);
  const uz = (p[b + 2] as number) - (p[a + 2] as number);
  const vx = (p[c] as number) - (p[a] as number);
  const vy = (p[c + 1] as number) - (p[a + 1] as number);
  const vz = (p[c + 2] as number) - (p[a + 2] as number);
  const x = uy * vz - uz * vy;
  const y = uz * vx - ux * vz;
  const z = ux * vy - uy * vx;
  return 0.5 * Math.sqrt(x * x + y * y + z * z);
}
