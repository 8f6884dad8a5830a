/** Wedges: corners with the same vertex and texture coordinates, which the GPU draws as one vertex. */
export interface Wedges {
  /** Per wedge: its vertex. */
  vertices: Uint32Array;
  uv: Float32Array; // 2 numbers each
  /** Three wedges a triangle, sorted by picture. */
  triangles: Uint32Array;
  /**
   * The triangles of each picture, from 0 on, in that order. `start` and `count` are 3 × the first triangle and 3 × the
   * number of triangles.
   */
  groups: { picture: number; start: number; count: number }[];
}

/**
 * Makes the wedges of triangles. `uv`: 2 numbers a corner. `pictures`: a number for each triangle; absent: 0 for all.
 * Yields now and then.
 */
export function* wedgesOf(
  triangles: Uint32Array,
  vertexCount: number,
  uv: Float32Array,
  pictures: Uint32Array | undefined,
): Generator<void, Wedges> {
  const first = new Int32Array(vertexCount).fill(-1); // per vertex: its first wedge, or -1
  const next = new Int32Array(triangles.length); // per wedge: the next wedge of its vertex
  const corner = new Uint32Array(triangles.length); // per wedge: its first corner
  const wedgeOf = new Uint32Array(triangles.length);
  let count = 0;
  for (let c = 0; c < triangles.length; ++c) {
    const v = triangles[c] as number;
    let wedge = first[v] as number;
    while (wedge >= 0 && !hasSameUv(uv, corner[wedge] as number, c)) wedge = next[wedge] as number;
    if (wedge < 0) {
      wedge = count++;
      corner[wedge] = c;
      next[wedge] = first[v] as number;
      first[v] = wedge;
    }
    wedgeOf[c] = wedge;
    if (c % 98304 === 0) yield;
  }
  const uvOfWedges = new Float32Array(2 * count);
  for (let w = 0; w < count; ++w) uvOfWedges.set(uv.subarray(2 * (corner[w] as number), 2 * (corner[w] as number) + 2), 2 * w);
  const vertices = new Uint32Array(count).map((_, w) => triangles[corner[w] as number] as number);
  return { vertices, uv: uvOfWedges, ...sorted(wedgeOf, pictures) };
}

function hasSameUv(uv: Float32Array, a: number, b: number): boolean {
  return uv[2 * a] === uv[2 * b] && uv[2 * a + 1] === uv[2 * b + 1];
}

function sorted(wedgeOf: Uint32Array, pictures: Uint32Array | undefined): Pick<Wedges, "triangles" | "groups"> {
  if (pictures === undefined)
    return { triangles: wedgeOf, groups: [{ picture: 0, start: 0, count: wedgeOf.length }] };
  const counts: number[] = [];
  for (const picture of pictures) counts[picture] = (counts[picture] ?? 0) + 3;
  let start = 0;
  const groups = Array.from(counts, (count = 0, picture) => ({ picture, start: (start += count) - count, count }));
  const ends = groups.map((group) => group.start);
  const triangles = new Uint32Array(wedgeOf.length);
  pictures.forEach((picture, t) => {
    const at = ends[picture] as number;
    triangles.set(wedgeOf.subarray(3 * t, 3 * t + 3), at);
    ends[picture] = at + 3;
  });
  return { triangles, groups: groups.filter(({ count }) => count > 0) };
}
