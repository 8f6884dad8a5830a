// Writes src/protocol.ts, the types of the messages between page and engine, from their one description.
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { compile } from "json-schema-to-typescript";

const at = (path) => fileURLToPath(new URL(path, import.meta.url));
const schema = JSON.parse(await readFile(at("../../src/editor/protocol.schema.json"), "utf8"));

// Names that a browser has of its own.
const titles = {
  error: "EngineError",
  event: "EngineEvent",
  request: "PageRequest",
  selection: "EditSelection",
  asked_selection: "AskedSelection",
};

// What checks a message but does not make a useful type: alternatives that only say which fields are needed, and
// the number of a request, which the connection gives.
function as_type(part) {
  if (Array.isArray(part)) return part.map(as_type);
  if (part === null || typeof part !== "object") return part;
  const { oneOf, ...rest } = with_shared_fields(part);
  const made = Object.fromEntries(Object.entries(rest).map(([key, value]) => [key, as_type(value)]));
  if (oneOf !== undefined && !oneOf.every((choice) => Object.keys(choice).join() === "required"))
    made.oneOf = as_type(oneOf);
  if (typeof made.$ref === "string") return { $ref: made.$ref };
  if (made.properties?.id === true) delete made.properties.id;
  for (const tag of ["do", "event"])
    if (made.properties?.[tag]?.const !== undefined || made.properties?.[tag]?.enum !== undefined)
      made.required = [...new Set([...(made.required ?? []), tag])];
  return made;
}

// Fields that several messages have stand in one definition; each message names those that it takes.
function with_shared_fields({ allOf, ...part }) {
  if (allOf === undefined) return part;
  const shared = Object.assign({}, ...allOf.map(({ $ref }) => schema.$defs[$ref.split("/").at(-1)].properties));
  const taken = Object.entries(part.properties).map(([name, as]) => [name, (name !== "id" && as === true && shared[name]) || as]);
  return { ...part, properties: Object.fromEntries(taken) };
}

// Kinds of binary messages are numbers with names.
const { message_kind: messageKind, ...described } = schema.$defs;
const messageKinds = [
  `/** ${messageKind.description.split(".")[0]}. */`,
  "export enum MessageKind {",
  ...messageKind.oneOf.map(({ const: number, title, description }) => `  /** ${description} */\n  ${title} = ${number},`),
  "}",
  "",
].join("\n");

const definitions = as_type(described);
definitions.request = { oneOf: definitions.request.oneOf };
definitions.event = { oneOf: definitions.event.oneOf };
for (const [name, title] of Object.entries(titles)) definitions[name].title = title;

// The compiler starts from one type: one that has all of them.
const names = Object.keys(definitions);
const root = {
  title: "Protocol",
  type: "object",
  additionalProperties: false,
  required: names,
  properties: Object.fromEntries(names.map((name) => [name, { $ref: `#/$defs/${name}` }])),
  $defs: definitions,
};
const types = await compile(root, "Protocol", {
  bannerComment: "// Made from src/editor/protocol.schema.json by tools/protocol_types.mjs: change it there.",
  additionalProperties: false,
  ignoreMinAndMaxItems: false,
});
await writeFile(at("../src/protocol.ts"), types + messageKinds);
