import type { BinaryMessage } from "../../engine/binary_message";

/** The seam of a graft: vertices of its result. */
export interface Seam {
  readonly vertices: Uint32Array;
  /** Of the whole result. A mesh of another number of vertices has another seam or none. */
  readonly vertexCount: number;
}

/** Returns the seam of the result in a message. */
export function seamOf(message: BinaryMessage): Seam {
  return { vertices: verticesFrom(message, 2), vertexCount: (message.floats("positions")?.length ?? 0) / 3 };
}

/** Returns the vertices of faces by origin: 1 for the part, 2 for new faces between the two. */
export function verticesFrom(message: BinaryMessage, kind: 1 | 2): Uint32Array {
  const triangles = message.indices("triangles") ?? new Uint32Array();
  const origin = message.bytes("origin") ?? new Uint8Array();
  const vertices = new Set<number>();
  origin.forEach((from, t) => {
    if (from === kind) for (const v of triangles.subarray(3 * t, 3 * t + 3)) vertices.add(v);
  });
  return Uint32Array.from(vertices);
}
