import type { BinaryMessage } from "../../engine/binary_message";
import type { Vector } from "../../protocol";
import type { Box } from "../editor";

/** The seam of a graft: vertices of its result. */
export interface Seam {
  readonly vertices: Uint32Array;
  /** Of the whole result. A mesh of another number of vertices has another seam or none. */
  readonly vertexCount: number;
  /** The bounding box of the triangles that were the target's. */
  readonly target: Box;
}

/** Returns the seam of the result in a message. */
export function seamOf(message: BinaryMessage): Seam {
  const positions = message.floats("positions") ?? new Float32Array();
  return { vertices: verticesFrom(message, 2), vertexCount: positions.length / 3, target: targetBox(message, positions) };
}

function targetBox(message: BinaryMessage, positions: Float32Array): Box {
  const low: Vector = [Infinity, Infinity, Infinity];
  const high: Vector = [-Infinity, -Infinity, -Infinity];
  const offset = message.header.offset ?? [0, 0, 0];
  for (const v of trianglesFrom(message, (origin) => origin === 0))
    for (const k of [0, 1, 2] as const) {
      const x = (positions[3 * v + k] ?? 0) + offset[k];
      low[k] = Math.min(low[k], x);
      high[k] = Math.max(high[k], x);
    }
  return { low, high };
}

/** Returns the vertices of faces by origin: 1 for the part, 2 for new faces between the two. */
export function verticesFrom(message: BinaryMessage, kind: 1 | 2): Uint32Array {
  return Uint32Array.from(new Set(trianglesFrom(message, (origin) => origin === kind)));
}

/** Returns the triangles of some origins, three vertices each. */
export function trianglesFrom(message: BinaryMessage, isWanted: (origin: number) => boolean): Uint32Array {
  const triangles = message.indices("triangles") ?? new Uint32Array();
  const origin = message.bytes("origin") ?? new Uint8Array();
  return triangles.filter((_, corner) => isWanted(origin[Math.floor(corner / 3)] ?? 0));
}
