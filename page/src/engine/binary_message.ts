import { MessageKind, type MessageHeader } from "../protocol";

export { MessageKind };

const types = { float32: Float32Array, uint32: Uint32Array, uint8: Uint8Array } as const;

const headLength = 24;

/** Assembles messages that arrive in parts, one after another. */
export class PartedMessages {
  private whole = new Uint8Array();

  /**
   * Returns the message that these bytes are or complete; undefined while parts are still to come. Throws if a part is
   * missing.
   */
  take(bytes: ArrayBuffer): ArrayBuffer | undefined {
    const head = new DataView(bytes);
    if (bytes.byteLength < headLength || head.getUint32(0, true) !== 0x5046474d) return bytes;
    const at = Number(head.getBigUint64(8, true));
    const length = Number(head.getBigUint64(16, true));
    if (at === 0) this.whole = new Uint8Array(length);
    const part = new Uint8Array(bytes, headLength);
    if (this.whole.length !== length) throw new Error("a part of a message is missing");
    this.whole.set(part, at);
    if (at + part.length < length) return undefined;
    const { buffer } = this.whole;
    this.whole = new Uint8Array();
    return buffer;
  }
}

type NumberArray = Float32Array | Uint32Array | Uint8Array;

/** One of several arrays of a name, with the name or the number of the thing that it belongs to. */
interface OwnedArray {
  name: string;
  owner: string | number;
  array: NumberArray;
}

/** A binary message of the engine: its header and its arrays, which are views into the message's bytes. */
export class BinaryMessage {
  private readonly arrays = new Map<string, NumberArray>();
  private readonly owned: OwnedArray[] = [];

  private constructor(
    readonly kind: MessageKind,
    readonly header: MessageHeader,
  ) {}

  /** Parses a message. Throws if `bytes` are not a valid one. */
  static parse(bytes: ArrayBuffer): BinaryMessage {
    const start = new DataView(bytes);
    if (bytes.byteLength < 12 || start.getUint32(0, true) !== 0x3146474d) throw new Error("not a message of meshgraft");
    const length = start.getUint32(8, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 12, length))) as MessageHeader;
    const message = new BinaryMessage(start.getUint32(4, true), header);
    let at = 12 + length;
    for (const { name, of: owner, type, length } of header.arrays) {
      const array = new types[type](bytes, at, length);
      if (owner === undefined) message.arrays.set(name, array);
      else message.owned.push({ name, owner, array });
      at += 4 * Math.ceil(array.byteLength / 4);
    }
    return message;
  }

  /** Returns the vertices of each handle, by its name. */
  handles(): Map<string, Uint32Array> {
    const found = new Map<string, Uint32Array>();
    for (const { name, owner, array } of this.owned)
      if (name === "handle" && array instanceof Uint32Array) found.set(String(owner), array);
    return found;
  }
  /** Returns the bytes of each picture, by its number. */
  pictures(): Map<number, Uint8Array<ArrayBuffer>> {
    const found = new Map<number, Uint8Array<ArrayBuffer>>();
    for (const { name, owner, array } of this.owned)
      if (name === "picture" && array instanceof Uint8Array) found.set(Number(owner), array as Uint8Array<ArrayBuffer>);
    return found;
  }
  /** Returns the mesh that has each picture, and the picture's number there, by the number that it has here. */
  sharedPictures(): Map<number, readonly [mesh: number, number: number]> {
    const found = new Map<number, readonly [number, number]>();
    for (const { name, owner, array } of this.owned)
      if (name === "shared_picture") found.set(Number(owner), [array[0] ?? 0, array[1] ?? 0]);
    return found;
  }
  floats(name: string): Float32Array | undefined {
    const array = this.arrays.get(name);
    return array instanceof Float32Array ? array : undefined;
  }
  indices(name: string): Uint32Array | undefined {
    const array = this.arrays.get(name);
    return array instanceof Uint32Array ? array : undefined;
  }
  bytes(name: string): Uint8Array<ArrayBuffer> | undefined {
    const array = this.arrays.get(name);
    return array instanceof Uint8Array ? (array as Uint8Array<ArrayBuffer>) : undefined;
  }
}
