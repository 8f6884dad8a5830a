// Writes src/facts.ts, the types of the facts in the engine's errors and notes, from the tables of facts.
import { writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { rowsOf, tables } from "./fact_tables.mjs";

const kinds = { integer: "number", number: "number", text: "string", integers: "number[]", numbers: "number[]", texts: "string[]" };

const rows = (await Promise.all((await tables()).map(rowsOf))).flat();
const typeOf = (kind) => kinds[kind] ?? Object.keys(kind).map((word) => JSON.stringify(word)).join(" | ");
const typesOf = (fields) =>
  Object.entries(fields).map(([name, kind]) => `${/^\w+$/.test(name) ? name : JSON.stringify(name)}: ${typeOf(kind)}`);
const lines = rows.map(({ id, fields }) => `  ${JSON.stringify(id)}: { ${typesOf(fields).join("; ")} };`);
const text = [
  "// Made from the tables of facts (src/*/facts.json) by tools/fact_types.mjs: change them there.",
  "",
  "/** The fields of each fact, by its id. */",
  "export interface FactFields {",
  ...lines,
  "}",
  "",
  "export type FactId = keyof FactFields;",
  "",
].join("\n");
await writeFile(fileURLToPath(new URL("../src/facts.ts", import.meta.url)), text);
