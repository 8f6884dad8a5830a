/**
 * Area-weighted vertex normals of the moving part of a mesh: all corners of triangles with a moving vertex. These are
 * found once; each `update` then costs one pass over them.
 */
export class NormalsOfPart {
  private constructor(
    private readonly triangles: Uint32Array,
    private readonly faces: Uint32Array, // of triangles around `vertices`: index of the first corner in `triangles`
    readonly vertices: Uint32Array, // those whose normals change, ascending
  ) {}

  /** `moving`: vertices; undefined: all. Yields now and then. */
  static *find(triangles: Uint32Array, vertexCount: number, moving?: Uint32Array): Generator<void, NormalsOfPart> {
    if (moving === undefined) {
      const vertices = new Uint32Array(vertexCount);
      for (let v = 0; v < vertexCount; ++v) vertices[v] = v;
      yield;
      const faces = new Uint32Array(triangles.length / 3);
      for (let f = 0; f < faces.length; ++f) faces[f] = 3 * f;
      yield;
      return new NormalsOfPart(triangles, faces, vertices);
    }
    const moves = new Uint8Array(vertexCount);
    for (const v of moving) moves[v] = 1;
    const changed = moves.slice();
    yield* touchedBy(triangles, moves, (at) => {
      for (let k = 0; k < 3; ++k) changed[triangles[at + k] as number] = 1;
    });
    const faces: number[] = [];
    yield* touchedBy(triangles, changed, (at) => faces.push(at));
    const vertices: number[] = [];
    changed.forEach((is, v) => is === 1 && vertices.push(v));
    return new NormalsOfPart(triangles, Uint32Array.from(faces), Uint32Array.from(vertices));
  }

  /** Writes the normals of `vertices` into `normals`. Yields now and then; the normals are valid only at the end. */
  *update(positions: Float32Array, normals: Float32Array): Generator<void, void> {
    const { triangles, faces, vertices } = this;
    for (let i = 0; i < vertices.length; ++i) {
      const at = 3 * (vertices[i] as number);
      normals[at] = normals[at + 1] = normals[at + 2] = 0;
      if (i % 262144 === 262143) yield;
    }
    yield;
    for (let i = 0; i < faces.length; ++i) {
      addFace(positions, triangles, faces[i] as number, normals);
      if (i % 65536 === 65535) yield;
    }
    for (let i = 0; i < vertices.length; ++i) {
      makeUnit(normals, 3 * (vertices[i] as number));
      if (i % 131072 === 131071) yield;
    }
  }
}

function* touchedBy(triangles: Uint32Array, marked: Uint8Array, what: (at: number) => void): Generator<void, void> {
  for (let at = 0; at < triangles.length; at += 3) {
    const any = (marked[triangles[at] as number] as number) + (marked[triangles[at + 1] as number] as number);
    if (any + (marked[triangles[at + 2] as number] as number) > 0) what(at);
    if (at % 393216 === 0) yield;
  }
}

function addFace(p: Float32Array, triangles: Uint32Array, at: number, normals: Float32Array): void {
  const a = 3 * (triangles[at] as number);
  const b = 3 * (triangles[at + 1] as number);
  const c = 3 * (triangles[at + 2] as number);
  const ax = p[a] as number;
  const ay = p[a + 1] as number;
  const az = p[a + 2] as number;
  const ux = (p[b] as number) - ax;
  const uy = (p[b + 1] as number) - ay;
  const uz = (p[b + 2] as number) - az;
  const vx = (p[c] as number) - ax;
  const vy = (p[c + 1] as number) - ay;
  const vz = (p[c + 2] as number) - az;
  const x = uy * vz - uz * vy;
  const y = uz * vx - ux * vz;
  const z = ux * vy - uy * vx;
  add(normals, a, x, y, z);
  add(normals, b, x, y, z);
  add(normals, c, x, y, z);
}

function add(normals: Float32Array, at: number, x: number, y: number, z: number): void {
  normals[at] = (normals[at] as number) + x;
  normals[at + 1] = (normals[at + 1] as number) + y;
  normals[at + 2] = (normals[at + 2] as number) + z;
}

function makeUnit(normals: Float32Array, at: number): void {
  const x = normals[at] as number;
  const y = normals[at + 1] as number;
  const z = normals[at + 2] as number;
  const length = Math.sqrt(x * x + y * y + z * z);
  if (length === 0) return;
  normals[at] = x / length;
  normals[at + 1] = y / length;
  normals[at + 2] = z / length;
}
