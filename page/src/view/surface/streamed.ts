import type { BinaryMessage } from "../../engine/binary_message";
import { NormalsOfPart } from "./normals";
import type { Slices } from "./slices";
import { sameList } from "./spans";

/** The mesh at rest, 3 numbers per vertex or triangle. */
interface AtRest {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly triangles: Uint32Array;
}

interface Listeners {
  /** Reports the vertices whose positions or normals have changed; undefined: all. */
  changed: (positions: Uint32Array | undefined, normals: Uint32Array | undefined) => void;
  /** Reports that a frame is completely shown. */
  shown: (frame: BinaryMessage) => void;
}

/**
 * The positions and normals of a surface by the engine's frames. Normals of large meshes are computed in slices, and
 * positions are shown only together with their normals. Of the frames that arrive meanwhile, only the newest is shown
 * next.
 */
export class StreamedFrames {
  /** At rest these are the mesh's own arrays. */
  positions: Float32Array;
  normals: Float32Array;
  private own: { positions: Float32Array; normals: Float32Array } | undefined;
  private waiting: BinaryMessage | undefined;
  private moving: Uint32Array | undefined; // vertices of the last frame; undefined: all
  private moved: NormalsOfPart | undefined; // of `moving`

  constructor(
    private readonly rest: AtRest,
    private readonly slices: Slices,
    private readonly listeners: Listeners,
  ) {
    this.positions = rest.positions;
    this.normals = rest.normals;
  }

  get isAtRest(): boolean {
    return this.positions === this.rest.positions;
  }

  /** Shows the positions of a frame, for all vertices or for those that it lists. The others are at rest. */
  show(frame: BinaryMessage): void {
    this.waiting = frame;
    if (!this.slices.isRunning("frames")) this.slices.start("frames", this.follow());
  }

  /** Shows all vertices at rest. */
  showRest(): void {
    this.slices.stop("frames");
    this.waiting = undefined;
    this.moved = undefined;
    this.positions = this.rest.positions;
    this.normals = this.rest.normals;
  }

  private *follow(): Generator<void, void> {
    for (let frame = this.next(); frame !== undefined; frame = this.next()) {
      const vertices = frame.indices("vertices");
      const isOther = this.isAtRest || this.moved === undefined || !sameList(vertices, this.moving);
      if (isOther) yield* this.begin(vertices);
      const { moved } = this;
      if (moved === undefined) continue;
      const sent = frame.floats("positions") ?? new Float32Array();
      if (vertices === undefined) this.positions.set(sent);
      else scatter(sent, vertices, this.positions);
      yield;
      yield* moved.update(this.positions, this.normals);
      this.listeners.changed(isOther ? undefined : vertices, isOther ? undefined : moved.vertices);
      this.listeners.shown(frame);
    }
  }

  private next(): BinaryMessage | undefined {
    const frame = this.waiting;
    this.waiting = undefined;
    return frame;
  }

  /** Prepares for a different set of moving vertices, and resets all others to rest. */
  private *begin(vertices: Uint32Array | undefined): Generator<void, void> {
    const { rest } = this;
    this.own ??= {
      positions: new Float32Array(rest.positions.length),
      normals: new Float32Array(rest.positions.length),
    };
    this.moving = vertices;
    this.moved = yield* NormalsOfPart.find(rest.triangles, rest.positions.length / 3, vertices);
    yield;
    ({ positions: this.positions, normals: this.normals } = this.own);
    this.positions.set(rest.positions);
    this.normals.set(rest.normals);
  }
}

function scatter(sent: Float32Array, vertices: Uint32Array, positions: Float32Array): void {
  for (let i = 0; i < vertices.length; ++i) {
    const v = 3 * (vertices[i] as number);
    positions[v] = sent[3 * i] as number;
    positions[v + 1] = sent[3 * i + 1] as number;
    positions[v + 2] = sent[3 * i + 2] as number;
  }
}
