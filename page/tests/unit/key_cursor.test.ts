import { describe, expect, test } from "vitest";
import { announcementOf, openedWords, selectionWords } from "../../src/app/announcements";
import { gripWords } from "../../src/tools/gizmo_layout";
import { cursorAction } from "../../src/tools/key_cursor";

const press = (key: string, more: Partial<Record<"shiftKey" | "altKey" | "ctrlKey" | "metaKey", boolean>> = {}) =>
  cursorAction({ key, shiftKey: false, altKey: false, ctrlKey: false, metaKey: false, ...more });

describe("the keys of the view's cursor", () => {
  test("move it by steps of three lengths, and turn the view with ctrl", () => {
    const lengthOf = (more: Parameters<typeof press>[1]) => {
      const action = press("ArrowLeft", more);
      return action?.kind === "move" ? -action.dx : NaN;
    };
    expect(lengthOf({ altKey: true })).toBeLessThan(lengthOf({}));
    expect(lengthOf({})).toBeLessThan(lengthOf({ shiftKey: true }));
    expect(press("ArrowUp")).toMatchObject({ kind: "move", dx: 0 });
    expect(press("ArrowDown", { ctrlKey: true })?.kind).toBe("orbit");
    expect(press("ArrowDown", { metaKey: true })?.kind).toBe("orbit");
  });
  test("press and zoom, and leave all other keys to the commands", () => {
    expect(press(" ")).toEqual({ kind: "press" });
    const [nearer, farther] = ["PageUp", "PageDown"].map((key) => press(key));
    if (nearer?.kind !== "zoom" || farther?.kind !== "zoom") throw new Error("no zoom");
    expect(nearer.factor * farther.factor).toBeCloseTo(1);
    expect(nearer.factor).toBeLessThan(1);
    for (const key of ["Enter", "b", "Tab", "Escape"]) expect(press(key)).toBeUndefined();
    expect(press(" ", { ctrlKey: true })).toBeUndefined();
  });
});

describe("what is read out", () => {
  test("says what came of a request", () => {
    const before = { undo: "pose", redo: "sculpt", graft: null } as const;
    expect(announcementOf({ do: "undo" }, {}, before)).toBe("Undone: move.");
    expect(announcementOf({ do: "redo" }, {}, before)).toBe("Redone: shaping.");
    expect(announcementOf({ do: "undo" }, {}, { undo: null, redo: null, graft: null })).toBeUndefined();
    expect(announcementOf({ do: "select", how: "invert" }, { selected: 3 }, before)).toBe("3 vertices selected.");
    expect(announcementOf({ do: "handle", what: "remove", name: "ear" }, {}, before)).toBe("ear is removed.");
    expect(announcementOf({ do: "pose", poses: { ear: {} } }, {}, before)).toBe("ear: moved.");
    expect(announcementOf({ do: "symmetry", plane: null }, {}, before)).toBe("Symmetry is off.");
    expect(announcementOf({ do: "list" }, {}, before)).toBeUndefined();
  });
  test("counts", () => {
    expect([0, 1].map(selectionWords)).toEqual(["Nothing is selected.", "1 vertex selected."]);
  });
  test("names each grip and its effect", () => {
    expect(gripWords({ kind: "arrow", axis: 2 })).toBe("Arrow: moves along Z.");
    expect(gripWords({ kind: "knob", axis: "free" })).toBe("Knob: scales.");
  });
  test("says what was opened", () => {
    const model = { vertices: 4, faces: 1 } as Parameters<typeof openedWords>[0]["model"];
    expect(openedWords({ name: "bar", model })).toBe("bar is open: 4 vertices, 1 face.");
  });
});
