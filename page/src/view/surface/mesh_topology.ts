/** A hash table (open addressing) that counts pairs of numbers, for millions of edges. */
class PairTable {
  private readonly first: Uint32Array;
  private readonly second: Uint32Array;
  readonly counts: Uint8Array;
  private readonly mask: number;

  constructor(expected: number) {
    let size = 16;
    while (size < 2 * expected) size *= 2;
    this.mask = size - 1;
    this.first = new Uint32Array(size);
    this.second = new Uint32Array(size);
    this.counts = new Uint8Array(size);
  }

  count(a: number, b: number): void {
    let at = (Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b)) >>> 0;
    at = (at ^ (at >>> 15)) & this.mask;
    while (this.counts[at] !== 0 && (this.first[at] !== a || this.second[at] !== b)) at = (at + 1) & this.mask;
    this.first[at] = a;
    this.second[at] = b;
    if ((this.counts[at] as number) < 255) this.counts[at] = (this.counts[at] as number) + 1;
  }

  /** Returns the counted pairs, one after another. `once`: only those counted exactly once. */
  pairs(once: boolean): Uint32Array {
    const wanted = (n: number) => (once ? n === 1 : n > 0);
    let total = 0;
    for (const n of this.counts) if (wanted(n)) ++total;
    const pairs = new Uint32Array(2 * total);
    let at = 0;
    this.counts.forEach((n, i) => {
      if (!wanted(n)) return;
      pairs[at++] = this.first[i] as number;
      pairs[at++] = this.second[i] as number;
    });
    return pairs;
  }
}

/** Returns each edge once, and the edges of only one triangle (the boundary): two vertices each, the lesser first. */
export function edgesOf(triangles: Uint32Array, vertexCount: number): { edges: Uint32Array; boundary: Uint32Array } {
  const table = new PairTable(Math.min(triangles.length, Math.max(4 * vertexCount, triangles.length / 1.8)));
  for (let at = 0; at < triangles.length; at += 3)
    for (let k = 0; k < 3; ++k) {
      const a = triangles[at + k] as number;
      const b = triangles[at + ((k + 1) % 3)] as number;
      if (a !== b) table.count(Math.min(a, b), Math.max(a, b));
    }
  return { edges: table.pairs(false), boundary: table.pairs(true) };
}

/**
 * Returns a coarse version of a mesh on the same vertices, with about `count` triangles. The vertices in one cell of a
 * grid are merged into one of them. Triangles that keep three distinct corners remain.
 */
export function coarseTriangles(positions: Float32Array, triangles: Uint32Array, count: number): Uint32Array {
  const representatives = representativesOf(positions, Math.sqrt((2 * areaOf(positions, triangles)) / count));
  const kept = new Uint32Array(triangles.length);
  let length = 0;
  for (let at = 0; at < triangles.length; at += 3) {
    const a = representatives[triangles[at] as number] as number;
    const b = representatives[triangles[at + 1] as number] as number;
    const c = representatives[triangles[at + 2] as number] as number;
    if (a === b || b === c || c === a) continue;
    kept[length] = a;
    kept[length + 1] = b;
    kept[length + 2] = c;
    length += 3;
  }
  return kept.slice(0, length);
}

function areaOf(p: Float32Array, triangles: Uint32Array): number {
  let area = 0;
  const every = 3 * Math.max(1, Math.floor(triangles.length / 300000)); // a sample suffices
  for (let at = 0; at + 2 < triangles.length; at += every) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * (triangles[at + k] as number)) as [number, number, number];
    const u = [0, 1, 2].map((k) => (p[b + k] as number) - (p[a + k] as number)) as [number, number, number];
    const v = [0, 1, 2].map((k) => (p[c + k] as number) - (p[a + k] as number)) as [number, number, number];
    area += 0.5 * Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  }
  return (area * every) / 3;
}

/** Returns for each vertex the first vertex in its grid cell. */
function representativesOf(positions: Float32Array, cell: number): Uint32Array {
  const firstIn = new Map<number, number>();
  const representatives = new Uint32Array(positions.length / 3);
  const cellOf = (i: number) => Math.floor((positions[i] as number) / cell) + 0x8000;
  for (let v = 0; v < representatives.length; ++v) {
    const key = (cellOf(3 * v) * 0x10000 + cellOf(3 * v + 1)) * 0x10000 + cellOf(3 * v + 2);
    const first = firstIn.get(key);
    if (first === undefined) firstIn.set(key, v);
    representatives[v] = first ?? v;
  }
  return representatives;
}
