import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { MessageKind } from "../../src/protocol";

const schemaFile = new URL("../../../src/editor/protocol.schema.json", import.meta.url);

test("the kinds of binary messages are those of the protocol's schema", () => {
  const schema = JSON.parse(readFileSync(schemaFile, "utf8")) as {
    $defs: { message_kind: { oneOf: { const: number; title: string }[] } };
  };
  const kinds = schema.$defs.message_kind.oneOf;
  expect(kinds.length).toBeGreaterThan(0);
  const names = Object.keys(MessageKind).filter((name) => Number.isNaN(Number(name)));
  expect(names).toEqual(kinds.map(({ title }) => title));
  for (const { const: number, title } of kinds) expect(MessageKind[title as keyof typeof MessageKind]).toBe(number);
});
