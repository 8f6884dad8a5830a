// Reads the tables of facts of the library and of the editor (tools/facts.py says what is in them).
import { readdir, readFile } from "node:fs/promises";
import { basename, dirname } from "node:path";
import { fileURLToPath } from "node:url";

const sources = fileURLToPath(new URL("../../src/", import.meta.url));

/** Returns the paths of all tables. */
export async function tables() {
  const files = await readdir(sources, { recursive: true });
  return files.filter((file) => basename(file) === "facts.json").sort().map((file) => sources + file);
}

/** Returns the rows of a table, each with its id. A field that is of a list of words has the list as its kind. */
export async function rowsOf(table) {
  const layer = basename(dirname(table));
  const { words = {}, ...rows } = JSON.parse(await readFile(table, "utf8"));
  const kindsOf = (fields) => Object.fromEntries(Object.entries(fields).map(([name, kind]) => [name, words[kind] ?? kind]));
  return Object.entries(rows).map(([name, { fields = {}, ...row }]) => ({ ...row, fields: kindsOf(fields), id: `${layer}.${name}` }));
}
