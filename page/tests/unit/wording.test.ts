import { describe, expect, test } from "vitest";
import { fieldsOf, fileToReplace, inPanelWords, noteWords, toldOf, type PageError } from "../../src/app/wording";
import { graftRemedy } from "../../src/app/graft/graft_remedies";
import type { EngineError, Fields } from "../../src/protocol";
import type { Row } from "../../tools/fact_tables.mjs";
import { countsFor, errorOf, fieldsFor, noteOf, ofFiles, rows, said, sampleOf } from "./facts_said";

const command = /\bmeshgraft (run|edit|repair|info|check|cut|merge|deform|compare|sample|convert|render|picture)\b/;

// Words of the library, of edit files and of how a program was built, which a window with panels does not use.
const notOfThePage = [
  /\[\d/, // steps[0]
  /\bcomponent \d/i,
  /(numbered|counted|from loop) \w*\s?(from )?0\b/i,
  /MESHGRAFT_/,
  /\b(fix_winding|OpenBLAS|sha-?256)\b/i,
  /\bthe (source|target)\b/i,
  /\b(source|target) (vertex|vertices|loop)\b/i,
  /'(at|union|minus|intersect|mirror|align|symmetry|pairs|iterations|matrix|region|curve|sel|take|min|max|edit|mesh)'/,
  /"pose"/,
  /\bin work\b/,
  /\bfields? '/,
  /\bmethod '/,
  /\bmethod named\b/,
  /'?(corotational|rotation-aware|ft05)\b/,
  /pose-(in)?dependent/,
  /\ba request\b/,
  /\bstdin|standard (input|output)\b/i,
];
describe("every fact is worded for a window with panels", () => {
  test("there are facts", () => expect(rows.length).toBeGreaterThan(300));
  test.each(rows.map((row) => [row.id, row] as const))("%s", (id, row) => {
    for (const count of countsFor(row)) {
      const text = said(row, fieldsFor(row, count));
      expect(text.trim()).not.toBe("");
      expect(text).not.toMatch(/\{\w+(:[^}]*)?\}/);
      expect(text).not.toMatch(/undefined|NaN|\[object/);
      if (id !== "script.wrong_type") expect(text).not.toMatch(/null/); // there it is JSON's null in a file
      expect(text).not.toMatch(/::/);
      expect(text).not.toMatch(/\w_\w/); // sample values have no underscores, but identifiers do
      expect(text).not.toMatch(/steps? (are |is )?(counted|numbered) from 0/i);
      expect(text).not.toMatch(/\.\./);
      if (!ofFiles(id)) for (const words of notOfThePage) expect(text).not.toMatch(words);
      expect(text).not.toMatch(/(^|\s)--\w/);
      expect(text).not.toMatch(command);
    }
  });
  test.each(rows.map((row) => [row.id, row] as const))("%s, with numbers that are not finite", (_, row) => {
    const fields = Object.entries(row.fields).map(([name, kind]) => [name, kind === "number" ? null : sampleOf(kind, 3)]);
    expect(said(row, Object.fromEntries(fields))).not.toMatch(/undefined|NaN/);
  });
});

const rowNamed = (id: string) => rows.find((row) => row.id === id) as Row;
const errorNamed = (id: string, fields: Fields, more: Partial<EngineError> = {}): EngineError => ({
  ...errorOf(rowNamed(id), fields),
  ...more,
});

describe("an error", () => {
  const held = { vertex: 5, handle: "nose" };
  test("lies in a step, counted as the panel counts", () => {
    const located = (more: Partial<EngineError>) => inPanelWords(errorNamed("deform.vertex_of_two_handles", held, more)).location;
    expect(located({ step: 1, location: "" })).toBe("Step 2");
    expect(located({ step: 2, location: "pose", handle: "nose" })).toBe("Step 3, “nose”");
    expect(located({ step: 2, location: "source_loop", pair: 0 })).toBe("Step 3, Pair 1");
    expect(located({ location: "/models/bust.ply", file: "/models/bust.ply" })).toBe("The file /models/bust.ply");
    expect(located({ location: "select" })).toBe(""); // a field of the request
    expect(located({ location: "" })).toBe("");
  });
  test("counts steps and pairs as the panels do", () => {
    expect(inPanelWords(errorNamed("editor.no_such_step", { step: 5, count: 2 }))).toMatchObject({
      problem: "there is no step 5; there are 2",
      remedy: "",
    });
    expect(noteWords(noteOf(rowNamed("merge.loop_rounded_off"), {}))).toBe(
      "The part's loop crosses itself as seen along its axis; the hole is rounded off.",
    );
  });
  test("has its reason before its remedy", () => {
    const reason = noteOf(rowNamed("merge.surface_too_narrow"), { size: 2 });
    const { problem, remedy } = inPanelWords(errorNamed("merge.no_hole", { size: 2, largest: 0.5 }, { notes: [reason] }));
    expect(problem).toBe("no hole can be opened there");
    expect(remedy).toBe(
      "The surface is too narrow there for the loop, at size 2. Use a size of at most 0.5, or drag it to another place.",
    );
  });
  test("of an id that the page does not know is told as the engine tells it", () => {
    const error: EngineError = {
      id: "new.fact", code: "io", fields: {}, problem: "a problem", location: "here", file: "here", remedy: "A remedy.",
      notes: [{ id: "new.note", fields: {}, text: "a reason" }],
    };
    expect(inPanelWords(error)).toEqual({ problem: "a problem", location: "The file here", remedy: "A reason. A remedy." });
  });
  test("of the page itself is told as it is, and is no fact", () => {
    const lost: PageError = { code: "io", problem: "a problem", location: "", remedy: "A remedy." };
    expect(toldOf(lost)).toBe(lost);
    expect(fieldsOf(lost, "io.file_exists")).toBeUndefined();
  });
  test("names the file that it would replace", () => {
    expect(fileToReplace(errorNamed("io.file_exists", { file: "a.ply" }))).toBe("a.ply");
    expect(fileToReplace(errorNamed("editor.file_changed", { file: "b.json" }))).toBe("b.json");
    expect(fileToReplace(errorNamed("deform.vertex_of_two_handles", held))).toBeUndefined();
  });
});

test("defects are told without the path of the file", () => {
  const note = noteOf(rowNamed("editor.defects"), { file: "a.obj", path: "it's a.obj", repaired: "b.obj" });
  expect(noteWords(note)).toBe(
    "The file a.obj has defects that can disturb editing. Defects, at the right, shows and mends them.",
  );
});

test("what the graft panel can do about a fact has a button", () => {
  expect(graftRemedy({ id: "merge.orientations_disagree", fields: {} })?.fields).toEqual({ fix_winding: true });
  expect(graftRemedy({ id: "merge.no_hole", fields: { size: 2, largest: 0.51234 } })).toEqual({
    label: "Use size 0.512", fields: { size: 0.51234 },
  });
  expect(graftRemedy({ id: "merge.pairs_invert_source", fields: { pair: 0, radii: 2, vertices: 9 } })?.fields).toEqual({
    retry: false,
  });
  expect(graftRemedy({ id: "merge.no_pairs", fields: {} })).toBeUndefined();
});
