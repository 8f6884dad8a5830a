import { signal } from "@preact/signals";
import { describe, expect, test } from "vitest";
import type { Outcome } from "../../src/engine/connection";
import { Marking } from "../../src/app/marking";
import { mendedWords, Mending, type Finding } from "../../src/app/mending";
import type { DocumentState, PageRequest } from "../../src/protocol";

const note = (id: string, count: number) => ({ id, fields: { count }, text: "" });
const turned: Finding = { kind: "inconsistent-winding", note: note("mesh.inconsistent_winding", 3), repairable: true };
const huge: Finding = { kind: "coordinate-too-large", note: note("mesh.too_large", 1), repairable: false };
const object = (name: string, mesh: number, findings: Finding[]) => ({
  name, mesh, vertices: 8, faces: 12, loops: 0, diagonal: 1, findings,
});

function stateOf(model: Finding[], part: Finding[]): DocumentState {
  return {
    event: "state", name: "bar", up: "y", front: "-y", unit: "", edit: "", model: object("a", 1, model), steps: [], handles: [], groups: [],
    counts: null, settings: {}, symmetry: null, notes: [], file: "a.ply", parts: [{ ...object("b", 2, part), grafted: false }],
    graft: null, selected: 0, selected_on: "a", undo: null, redo: null, set_up_for: null, dirty: false,
  };
}

function mendingOf(state: DocumentState, answer: Outcome = {}) {
  const asked: PageRequest[] = [];
  const told: string[] = [];
  let hidden = 0;
  const links = {
    state: signal<DocumentState | null>(state),
    ask: (request: PageRequest) => (asked.push(request), Promise.resolve(answer)),
    note: (problem: string) => told.push(problem),
    hideMarks: () => ++hidden,
  };
  const marking = new Marking(links);
  return { mending: new Mending({ ...links, marking }), marking, asked, told, hidden: () => hidden };
}

describe("mending", () => {
  test("lists the model and the parts that have defects", () => {
    const names = (state: DocumentState) => mendingOf(state).mending.defective.value.map(({ name }) => name);
    expect(names(stateOf([turned], []))).toEqual(["a"]);
    expect(names(stateOf([turned], [huge]))).toEqual(["a", "b"]);
    expect(names(stateOf([], []))).toEqual([]);
  });
  test("repairs all that can be repaired, object by object", async () => {
    const { mending, asked, told } = mendingOf(stateOf([turned], [huge]), { notes: [note("mesh.turned_face", 2)] });
    await mending.mendAll(["a", "b"]);
    expect(asked).toEqual([{ do: "repair", mesh: "a" }]);
    expect(told).toEqual(["Mended. 2 faces were turned over."]);
  });
  test("lights a kind up, and hides it by a second click or when a step changes", async () => {
    const state = stateOf([turned], []);
    const { mending, marking, asked, hidden } = mendingOf(state, { marked: 3 });
    marking.onState(state);
    await mending.toggle("a", "inconsistent-winding");
    expect(asked).toEqual([{ do: "mark", mesh: "a", finding: "inconsistent-winding" }]);
    expect(mending.isMarked("a", "inconsistent-winding")).toBe(true);
    marking.onState({ ...state, selected: 5 });
    expect(hidden()).toBe(0);
    await mending.toggle("a", "inconsistent-winding");
    expect(marking.marked.value).toBeNull();
    await mending.toggle("a", "inconsistent-winding");
    marking.onState({ ...state, steps: [{ kind: "repair", handles: 0, fields: {} }] });
    expect([marking.marked.value, hidden()]).toEqual([null, 2]);
  });
  test("says if there is nothing to see", async () => {
    const { mending, marking, told } = mendingOf(stateOf([huge], []), { marked: 0 });
    await mending.toggle("a", "coordinate-too-large");
    expect([told.length, marking.marked.value]).toEqual([1, null]);
  });
  test("says if nothing that is open can be closed", async () => {
    const { mending, asked, told } = mendingOf(stateOf([], []), { notes: [] });
    await mending.closeHoles("a");
    expect(asked).toEqual([{ do: "repair", mesh: "a", holes: true }]);
    expect(told).toEqual([expect.stringMatching(/^Nothing was closed: /)]);
  });
  test("waits for a graft to end", () => {
    const state = { ...stateOf([turned], []), graft: { graft: 1, step: {}, set_aside: [] } };
    expect(mendingOf(state).mending.canMend.value).toBe(false);
  });
  test("tells what was changed", () => {
    expect(mendedWords([])).toBe("Nothing had to be mended.");
    expect(mendedWords([note("mesh.filled_hole", 1), note("mesh.welded_vertex", 12)])).toBe(
      "Mended. 1 hole was closed. 12 vertices of open seams were joined.",
    );
  });
});
