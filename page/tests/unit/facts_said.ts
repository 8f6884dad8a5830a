// The facts of all tables with sample fields, and what the page says of them.
import { expect } from "vitest";
import { inPanelWords, noteWords, toldOfNote } from "../../src/app/wording";
import type { EngineError, Fields } from "../../src/protocol";
import { rowsOf, tables, type Kind, type Row, type Words } from "../../tools/fact_tables.mjs";

export const rows = (await Promise.all((await tables()).map(rowsOf))).flat();

/**
 * Fills in fields as the engine does: "{name}", "{name:.2g}", and "{count:face|faces}", which is "1 face" or "3 faces".
 * A word becomes the library's English for it.
 */
function filled(text: string, fields: Fields, { fields: kinds }: Row): string {
  const named = text.replace(/\{(\w+)(?::([^}]*))?\}(?!\})/g, (_, name: string, format = "") => {
    const kind = kinds[name];
    const value = typeof kind === "object" ? kind[String(fields[name])] : fields[name];
    const [one, many] = (format as string).split("|");
    if (many !== undefined) return `${value} ${value === 1 ? one : many}`;
    return Array.isArray(value) ? value.join(", ") : String(value);
  });
  return named.replaceAll("{{", "{").replaceAll("}}", "}");
}

const samples: Record<Kind, (count: number) => Fields[string]> = {
  integer: (count) => count,
  number: (count) => count / 2,
  text: () => "text",
  integers: (count) => Array.from({ length: count }, (_, i) => i),
  numbers: (count) => Array.from({ length: count }, (_, i) => i / 2),
  texts: (count) => Array.from({ length: count }, (_, i) => `text ${i}`),
};

export function sampleOf(kind: Kind | Words, count: number): Fields[string] {
  if (typeof kind === "string") return samples[kind](count);
  const words = Object.keys(kind);
  return words[count % words.length] as string;
}

export function fieldsFor({ fields }: Row, count: number): Fields {
  return Object.fromEntries(Object.entries(fields).map(([name, kind]) => [name, sampleOf(kind, count)]));
}

/** Returns counts with which every word of every list occurs. */
export function countsFor({ fields }: Row): number[] {
  const words = Object.values(fields).map((kind) => (typeof kind === "string" ? 0 : Object.keys(kind).length));
  return Array.from({ length: Math.max(3, ...words) }, (_, i) => i + 1);
}

const codes: Record<string, EngineError["code"]> = {
  usage: "usage", input: "input", unsolvable: "unsolvable", io: "io", memory: "memory", cancelled: "cancelled", internal: "internal",
};

export function errorOf(row: Row, fields: Fields): EngineError {
  const { id, code = "", problem = "", remedy = "" } = row;
  return {
    id, code: codes[code] ?? "internal", fields, location: "", notes: [],
    problem: filled(problem, fields, row), remedy: filled(remedy, fields, row),
  };
}

export function noteOf(row: Row, fields: Fields) {
  const { id, note = "", remedy } = row;
  const text = filled(note, fields, row);
  return { id, fields, text: remedy === undefined ? text : `${text}. ${filled(remedy, fields, row)}` };
}

/** Returns the problem and the remedy that the page shows for a fact. */
export function partsSaid(row: Row, fields: Fields): { problem: string; remedy: string } {
  return row.code === undefined ? toldOfNote(noteOf(row, fields)) : inPanelWords(errorOf(row, fields));
}

/** Returns the whole text that the page shows for a fact. */
export function said(row: Row, fields: Fields): string {
  if (row.code === undefined) return noteWords(noteOf(row, fields));
  const { problem, remedy } = partsSaid(row, fields);
  expect(problem).not.toBe("");
  return `${problem}. ${remedy}`;
}

/** Facts about what a file contains or lacks, which its reader names as it is written there. */
export const ofFiles = (id: string) =>
  fileFacts.has(id) || ofPrograms(id) || id.startsWith("io.") || id.startsWith("gltf.") || id.startsWith("threemf.");
const fileFacts: ReadonlySet<string> = new Set<string>([
  "script.misspelt_field", "script.misspelt_method", "script.missing_field", "script.no_such_method", "script.repeated_field",
  "script.unknown_field", "script.closed_no_curve", "script.not_a_match", "script.not_one_selection", "script.not_sel_and_take", "script.redrawn_no_curve",
]);
/** Facts of what the editor does not run: methods to compare with, solves on several machines, and a comparison. */
const ofPrograms = (id: string) => id.startsWith("baselines.") || id.startsWith("distributed.") || programFacts.has(id);
const programFacts: ReadonlySet<string> = new Set<string>([
  "deform.reduced_frames_needless", "script.method_given_twice", "script.no_anchors", "script.no_features",
]);
