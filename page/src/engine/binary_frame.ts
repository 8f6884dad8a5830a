import type { FrameHeader } from "../protocol";

/** What a binary message is about. */
export enum FrameKind {
  mesh = 1,
  frame = 2,
  weights = 3,
  selection = 4,
  roles = 5,
}

/** A binary message of the engine: its header, and its arrays, which lie in the message's own bytes. */
export class BinaryFrame {
  private readonly arrays = new Map<string, Float32Array | Uint32Array>();

  private constructor(
    readonly kind: FrameKind,
    readonly header: FrameHeader,
  ) {}

  /** Throws where `bytes` are not such a message. */
  static parse(bytes: ArrayBuffer): BinaryFrame {
    const start = new DataView(bytes);
    if (bytes.byteLength < 12 || start.getUint32(0, true) !== 0x3146474d) throw new Error("not a frame of meshgraft");
    const length = start.getUint32(8, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 12, length))) as FrameHeader;
    const frame = new BinaryFrame(start.getUint32(4, true), header);
    let at = 12 + length;
    for (const { name, type, length } of header.arrays) {
      frame.arrays.set(name, new (type === "float32" ? Float32Array : Uint32Array)(bytes, at, length));
      at += 4 * length;
    }
    return frame;
  }

  names(): string[] {
    return [...this.arrays.keys()];
  }
  floats(name: string): Float32Array | undefined {
    const array = this.arrays.get(name);
    return array instanceof Float32Array ? array : undefined;
  }
  indices(name: string): Uint32Array | undefined {
    const array = this.arrays.get(name);
    return array instanceof Uint32Array ? array : undefined;
  }
}
