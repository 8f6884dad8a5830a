// Vertex-to-triangle adjacency, and searches on it: shortest paths, connected components, boundary loops and patches.
// The engine decides on selections; these searches preview them.

/** A mesh as held by the view. */
export interface MeshArrays {
  readonly positions: Float32Array;
  readonly triangles: Uint32Array;
}

/** Vertices and their distances along edges. */
export type Distances = Map<number, number>;

export class MeshGraph {
  /** Boundary loops, each in order. */
  loops: readonly Uint32Array[] = [];

  private constructor(
    private readonly mesh: MeshArrays,
    private readonly corners: Uint32Array, // triangles, with coincident boundary vertices merged
    private readonly starts: Uint32Array, // per vertex: start of its triangles in `faces`
    private readonly faces: Uint32Array,
    private readonly joined: ReadonlyMap<number, number> = new Map(),
  ) {}

  /** Makes the graph, merging coincident boundary vertices. Yields now and then. */
  static *make(mesh: MeshArrays): Generator<void, MeshGraph> {
    const apart = yield* MeshGraph.of(mesh, mesh.triangles);
    const boundary = yield* apart.boundary();
    const joined = mergeCoincident(mesh, boundary);
    if (joined === undefined) {
      apart.loops = loopsOf(boundary);
      return apart;
    }
    const graph = yield* MeshGraph.of(mesh, mesh.triangles.map((v) => joined.get(v) ?? v), joined);
    graph.loops = loopsOf(yield* graph.boundary());
    return graph;
  }

  private static *of(
    mesh: MeshArrays, corners: Uint32Array, joined?: ReadonlyMap<number, number>,
  ): Generator<void, MeshGraph> {
    const count = mesh.positions.length / 3;
    const starts = new Uint32Array(count + 1);
    for (let i = 0; i < corners.length; ++i) {
      const next = (corners[i] as number) + 1;
      starts[next] = (starts[next] as number) + 1;
      if (i % slice === 0) yield;
    }
    for (let v = 0; v < count; ++v) starts[v + 1] = (starts[v + 1] as number) + (starts[v] as number);
    yield;
    const at = starts.slice();
    const faces = new Uint32Array(corners.length);
    for (let i = 0; i < corners.length; ++i) {
      const v = corners[i] as number;
      faces[at[v] as number] = (i / 3) | 0;
      at[v] = (at[v] as number) + 1;
      if (i % slice === 0) yield;
    }
    return new MeshGraph(mesh, corners, starts, faces, joined);
  }

  get vertexCount(): number {
    return this.starts.length - 1;
  }

  /** Returns the vertex that represents all vertices merged with this one. */
  first(vertex: number): number {
    return this.joined.get(vertex) ?? vertex;
  }

  /** Returns the triangles whose corners are all among these vertices. */
  facesInside(vertices: Iterable<number>): number[] {
    const inside = new Set<number>();
    for (const v of vertices) inside.add(this.first(v));
    const faces = new Set<number>();
    for (const v of inside)
      for (const face of this.facesOf(v))
        if ([0, 1, 2].every((k) => inside.has(this.corners[3 * face + k] as number))) faces.add(face);
    return [...faces];
  }

  facesOf(vertex: number): Uint32Array {
    return this.faces.subarray(this.starts[vertex], this.starts[vertex + 1]);
  }

  /** Returns the neighbours of a vertex. Some occur twice. */
  *neighbours(vertex: number): Generator<number> {
    for (const face of this.facesOf(vertex))
      for (let k = 0; k < 3; ++k) {
        const v = this.corners[3 * face + k] as number;
        if (v !== vertex) yield v;
      }
  }

  /**
   * Returns the shortest path along edges, including its ends; undefined if none is found within `mostVisited`
   * vertices.
   */
  path(from: number, to: number, mostVisited = 200_000): Uint32Array | undefined {
    const before = new Map<number, number>();
    const goal = (v: number) => this.distance(v, to);
    from = this.first(from);
    to = this.first(to);
    const found = this.spread([from], Infinity, mostVisited, before, { until: to, ahead: goal });
    if (!found.has(to)) return undefined;
    const path = [to];
    for (let v = before.get(to); v !== undefined; v = before.get(v)) path.push(v);
    return Uint32Array.from(path.reverse());
  }

  /** Returns the vertices within a length along edges, at most `mostVisited` of them. */
  within(vertices: Iterable<number>, length: number, mostVisited = 200_000): Distances {
    return this.spread(vertices, length, mostVisited);
  }

  /** Returns the connected component of a vertex. */
  component(vertex: number): Uint32Array {
    return this.walk(vertex, () => true);
  }

  /**
   * Returns the vertices reached from a vertex across edges where the normals of the two triangles differ by at most
   * `angleDeg`.
   */
  flood(vertex: number, angleDeg: number): Uint32Array {
    const least = Math.cos((angleDeg * Math.PI) / 180);
    return this.walk(vertex, (a, b) => this.cosine(a, b) >= least);
  }

  /** Returns the vertices that have a neighbour outside the set; all of them if none has. */
  boundaryOf(vertices: Uint32Array): number[] {
    const all = [...new Set(Array.from(vertices, (v) => this.first(v)))];
    const inside = new Set(all);
    const boundary = all.filter((v) => {
      for (const w of this.neighbours(v)) if (!inside.has(w)) return true;
      return false;
    });
    return boundary.length > 0 ? boundary : all;
  }

  // Dijkstra's algorithm, or A* if `goal` estimates the remaining distance.
  private spread(
    from: Iterable<number>, length: number, mostVisited: number,
    before?: Map<number, number>, goal?: { until: number; ahead: (v: number) => number },
  ): Distances {
    const distances: Distances = new Map();
    const best: Distances = new Map();
    const queue = new Queue();
    for (const given of from) {
      const v = this.first(given);
      best.set(v, 0);
      queue.push(v, goal?.ahead(v) ?? 0);
    }
    while (queue.size > 0 && distances.size < mostVisited) {
      const v = queue.pop();
      if (distances.has(v)) continue;
      const sofar = best.get(v) as number;
      distances.set(v, sofar);
      if (v === goal?.until) break;
      for (const w of this.neighbours(v)) {
        const next = sofar + this.distance(v, w);
        if (next > length || next >= (best.get(w) ?? Infinity)) continue;
        best.set(w, next);
        before?.set(w, v);
        queue.push(w, next + (goal?.ahead(w) ?? 0));
      }
    }
    return distances;
  }

  private walk(vertex: number, crosses: (from: number, to: number) => boolean): Uint32Array {
    const seen = new Uint8Array(this.corners.length / 3);
    const reached = new Uint8Array(this.vertexCount);
    const waiting = [...this.facesOf(this.first(vertex))];
    for (const face of waiting) seen[face] = 1;
    for (let face = waiting.pop(); face !== undefined; face = waiting.pop())
      for (let k = 0; k < 3; ++k) {
        const a = this.corners[3 * face + k] as number;
        const b = this.corners[3 * face + ((k + 1) % 3)] as number;
        reached[a] = 1;
        for (const other of this.facesOf(a))
          if (seen[other] === 0 && this.hasCorner(other, b) && crosses(face, other)) {
            seen[other] = 1;
            waiting.push(other);
          }
      }
    return marked(reached);
  }

  /** Returns the next boundary vertex of each boundary vertex. Yields now and then. */
  private *boundary(): Generator<void, Map<number, number>> {
    const next = new Map<number, number>();
    for (let face = 0; 3 * face < this.corners.length; ++face) {
      for (let k = 0; k < 3; ++k) {
        const a = this.corners[3 * face + k] as number;
        const b = this.corners[3 * face + ((k + 1) % 3)] as number;
        if (a !== b && !this.isShared(a, b, face)) next.set(a, b);
      }
      if (face % slice === 0) yield;
    }
    return next;
  }

  private isShared(a: number, b: number, face: number): boolean {
    for (let i = this.starts[a] as number; i < (this.starts[a + 1] as number); ++i) {
      const other = this.faces[i] as number;
      if (other !== face && this.hasCorner(other, b)) return true;
    }
    return false;
  }

  private hasCorner(face: number, v: number): boolean {
    const { corners } = this;
    return corners[3 * face] === v || corners[3 * face + 1] === v || corners[3 * face + 2] === v;
  }

  private distance(a: number, b: number): number {
    const p = this.mesh.positions;
    const at = (v: number, k: number) => p[3 * v + k] as number;
    return Math.hypot(at(a, 0) - at(b, 0), at(a, 1) - at(b, 1), at(a, 2) - at(b, 2));
  }

  // Returns the cosine of the angle between the normals of two triangles.
  private cosine(a: number, b: number): number {
    const m = this.normal(a);
    const n = this.normal(b);
    const size = Math.hypot(...m) * Math.hypot(...n);
    return size === 0 ? 1 : (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]) / size;
  }

  private normal(face: number): [number, number, number] {
    const p = this.mesh.positions;
    const [a, b, c] = [0, 1, 2].map((k) => 3 * (this.corners[3 * face + k] as number)) as [number, number, number];
    const side = (from: number, to: number, k: number) => (p[to + k] as number) - (p[from + k] as number);
    const [ux, uy, uz] = [side(a, b, 0), side(a, b, 1), side(a, b, 2)];
    const [vx, vy, vz] = [side(a, c, 0), side(a, c, 1), side(a, c, 2)];
    return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  }
}

const slice = 65_536;

function marked(flags: Uint8Array): Uint32Array {
  const found: number[] = [];
  flags.forEach((flag, v) => flag !== 0 && found.push(v));
  return Uint32Array.from(found);
}

// Merges boundary vertices at exactly the same position: the first represents all. Undefined if there are none.
function mergeCoincident({ positions }: MeshArrays, boundary: ReadonlyMap<number, number>): Map<number, number> | undefined {
  const first = new Map<string, number>();
  const joined = new Map<number, number>();
  for (const v of boundary.keys()) {
    const key = `${positions[3 * v]} ${positions[3 * v + 1]} ${positions[3 * v + 2]}`;
    const known = first.get(key);
    if (known === undefined) first.set(key, v);
    else joined.set(v, known);
  }
  return joined.size === 0 ? undefined : joined;
}

function loopsOf(next: ReadonlyMap<number, number>): Uint32Array[] {
  const seen = new Set<number>();
  const loops: Uint32Array[] = [];
  for (const start of next.keys()) {
    const loop: number[] = [];
    for (let v: number | undefined = start; v !== undefined && !seen.has(v); v = next.get(v)) {
      seen.add(v);
      loop.push(v);
    }
    if (loop.length > 2) loops.push(Uint32Array.from(loop));
  }
  return loops;
}

/** A binary heap of numbers, with the smallest key on top. */
class Queue {
  private readonly items: number[] = [];
  private readonly keys: number[] = [];

  get size(): number {
    return this.items.length;
  }

  push(item: number, key: number): void {
    const { items, keys } = this;
    let at = items.length;
    while (at > 0) {
      const above = (at - 1) >> 1;
      if ((keys[above] as number) <= key) break;
      items[at] = items[above] as number;
      keys[at] = keys[above] as number;
      at = above;
    }
    items[at] = item;
    keys[at] = key;
  }

  pop(): number {
    const { items, keys } = this;
    const top = items[0] as number;
    const item = items.pop() as number;
    const key = keys.pop() as number;
    const count = items.length;
    if (count === 0) return top;
    let at = 0;
    for (;;) {
      let below = 2 * at + 1;
      if (below >= count) break;
      if (below + 1 < count && (keys[below + 1] as number) < (keys[below] as number)) ++below;
      if ((keys[below] as number) >= key) break;
      items[at] = items[below] as number;
      keys[at] = keys[below] as number;
      at = below;
    }
    items[at] = item;
    keys[at] = key;
    return top;
  }
}
