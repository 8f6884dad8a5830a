import { expect, test } from "vitest";
import { BinaryMessage, MessageKind } from "../../src/engine/binary_message";

/** Returns the bytes of a message whose header lists these arrays. */
function messageOf(kind: MessageKind, arrays: object[], bytes: number[]): ArrayBuffer {
  const json = JSON.stringify({ mesh: 1, arrays });
  const header = new TextEncoder().encode(json.padEnd(4 * Math.ceil(json.length / 4)));
  const start = new Uint32Array([0x3146474d, kind, header.length]);
  return Uint8Array.from([...new Uint8Array(start.buffer), ...header, ...bytes]).buffer;
}

test("an array without `of` is found by its name, one with it by what it belongs to", () => {
  const indices = (name: string, of: string | undefined, length: number) => ({ name, of, type: "uint32", length });
  const roles = BinaryMessage.parse(
    messageOf(
      MessageKind.roles,
      [indices("fixed", undefined, 1), indices("handle", "a: b", 2), indices("handle", "fixed", 0)],
      [7, 0, 0, 0, 8, 0, 0, 0, 9, 0, 0, 0],
    ),
  );
  expect(roles.indices("fixed")).toEqual(Uint32Array.from([7]));
  expect(roles.indices("handle")).toBeUndefined();
  expect([...roles.handles()]).toEqual([["a: b", Uint32Array.from([8, 9])], ["fixed", new Uint32Array()]]);
  expect(roles.pictures().size).toBe(0);
});

test("pictures have numbers, and are padded to 4 bytes", () => {
  const picture = (of: number, length: number) => ({ name: "picture", of, type: "uint8", length });
  const mesh = BinaryMessage.parse(messageOf(MessageKind.mesh, [picture(1, 1), picture(2, 2)], [5, 0, 0, 0, 6, 7, 0, 0]));
  expect([...mesh.pictures()]).toEqual([[1, Uint8Array.from([5])], [2, Uint8Array.from([6, 7])]]);
  expect(mesh.handles().size).toBe(0);
});
