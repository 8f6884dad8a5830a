// Screen readers are told what came of each request.
import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { announcementOf, withoutWords } from "../../src/app/announcements";
import type { Outcome } from "../../src/engine/connection";
import type { DocumentState, PageRequest } from "../../src/protocol";

type Kind = PageRequest["do"];
type Told = [PageRequest, string, Outcome?];

const schemaFile = new URL("../../../src/editor/protocol.schema.json", import.meta.url);
interface Choice {
  properties?: { do?: { const?: string; enum?: string[] } };
}

/** Returns the kinds of requests of the protocol. */
function kindsOfSchema(): string[] {
  const { $defs } = JSON.parse(readFileSync(schemaFile, "utf8")) as { $defs: { request: { oneOf: Choice[] } } };
  const kinds = $defs.request.oneOf.flatMap(({ properties }) => properties?.do?.enum ?? [properties?.do?.const ?? ""]);
  return [...new Set(kinds)].sort();
}

const sound: NonNullable<Outcome["print"]> = {
  open_edges: 0, holes: 0, non_manifold_edges: 0, turned_edges: 0, inside_out: false, intersections: 0, thinnest_wall: 2,
  overhanging: 0, overhang_area: 0, area: 1, size: [1, 1, 1], volume: 1,
} as NonNullable<Outcome["print"]>;

const told: Record<Exclude<Kind, keyof typeof withoutWords>, Told[]> = {
  accept: [[{ do: "accept" }, "The step is accepted. The next one begins."]],
  cancel: [[{ do: "cancel" }, "Cancelled."]],
  cut: [[{ do: "cut", plane: { point: [0, 0, 0], normal: [1, 0, 0] }, keep: "above" }, "Cut."]],
  fixed: [[{ do: "fixed" }, "The selected vertices are fixed."]],
  graft: [
    [{ do: "graft", source: "head" }, "The graft of head begins."],
    [{ do: "graft", what: "swap" }, "Part and model are exchanged."],
    [{ do: "graft", what: "cancel" }, "The graft is cancelled."],
    [{ do: "graft", what: "resume" }, "The graft is edited again."],
  ],
  group: [[{ do: "group", name: "ears", remove: true }, "The group ears is removed."]],
  handle: [[{ do: "handle", what: "remove", name: "ear" }, "ear is removed."]],
  mark: [
    [{ do: "mark", print: "overhangs" }, "1 place lit up.", { marked: 1 }],
    [{ do: "mark", finding: "duplicate-face" }, "12 places lit up.", { marked: 12 }],
  ],
  "paint-handle": [[{ do: "paint-handle", vertices: [0], name: "tip" }, "tip is made."]],
  part: [
    [{ do: "part", what: "add", sample: "head" }, "head 2 is added as a part.", { name: "head 2" }],
    [{ do: "part", what: "remove", name: "head" }, "head is removed."],
    [{ do: "part", what: "edit", name: "head" }, "head is the model now."],
    [{ do: "part", what: "withdraw", name: "head" }, "head is not added."],
  ],
  pose: [[{ do: "pose", poses: { ear: {} } }, "ear: moved."]],
  "print-check": [
    [{ do: "print-check", up: [0, 0, 1] }, "Checked for printing: nothing stands against it.", { print: sound }],
    [
      { do: "print-check", up: [0, 0, 1], least_wall: 3 }, "Checked for printing: Open: 2 holes; Thinnest wall 2, below 3.",
      { print: { ...sound, open_edges: 9, holes: 2 } },
    ],
  ],
  reach: [[{ do: "reach", handle: "ear", reach: 1 }, "The reach is set."]],
  redo: [[{ do: "redo" }, "Redone: cut."]],
  region: [[{ do: "region" }, "Only the selected vertices may move."]],
  reset: [[{ do: "reset" }, "The step is reset."]],
  restore: [[{ do: "restore" }, "The changes are restored."]],
  sculpt: [[{ do: "sculpt", action: "smooth" }, "Shaped."]],
  select: [[{ do: "select", how: "invert" }, "3 vertices selected.", { selected: 3 }]],
  settings: [[{ do: "settings", settings: {} }, "The settings are changed."]],
  step: [[{ do: "step", what: "remove", index: 0 }, "The step is removed."]],
  symmetry: [[{ do: "symmetry", plane: null }, "Symmetry is off."]],
  transform: [[{ do: "transform", pose: {} }, "The model is moved or scaled."]],
  undo: [[{ do: "undo" }, "Undone: move."]],
};

describe("the answer to each request of the protocol", () => {
  test("has words, or a reason for having none", () => {
    expect([...Object.keys(told), ...Object.keys(withoutWords)].sort()).toEqual(kindsOfSchema());
    for (const reason of Object.values(withoutWords)) expect(reason.length).toBeGreaterThan(10);
  });
  const before = { undo: "pose", redo: "cut", graft: null } satisfies Pick<DocumentState, "undo" | "redo" | "graft">;
  test.each(Object.values(told).flat())("%o", (request, words, outcome = {}) => {
    expect(announcementOf(request, outcome, before)).toBe(words);
  });
  test("of a graft that is edited says that it is changed", () => {
    const graft = {} as DocumentState["graft"];
    expect(announcementOf({ do: "graft", size: 2 }, {}, { ...before, graft })).toBe("The graft is changed.");
  });
  test("that shows no place is told by a message alone", () => {
    expect(announcementOf({ do: "mark", print: "overhangs" }, { marked: 0 }, before)).toBeUndefined();
  });
});
