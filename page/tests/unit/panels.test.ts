import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { withMessage, type Box, type Message } from "../../src/app/editor";
import { handleColour, groupColour } from "../../src/app/colours";
import { isAtRest, nameOfAxis, numbersOf, withNumbers } from "../../src/app/handle_pose";
import { liveWords, progressWords } from "../../src/app/live_words";
import {
  admissible, applicable, changesToDefaults, choiceOf, methodOf, numberOf, settingOf, settingsTable, type ChoiceSetting, type NumberSetting,
} from "../../src/app/method_settings";
import { axisOfPlane, coordinateOf, planeAcross } from "../../src/app/mirror_plane";
import { compareNames, baseName, faultOfName, folderOf, joined, stemOf, withExtension } from "../../src/app/paths";
import { refusalOf, uploadLimit } from "../../src/app/upload";
import { sufficientTolerance, withTolerance } from "../../src/app/symmetry";
import { asTyped } from "../../src/app/units";
import { inPanelWords } from "../../src/app/wording";
import { holeEdgesOf, holesOf } from "../../src/panels/repair_details";
import { rangeWords, isInRange, Track } from "../../src/panels/ui/fields";
import type { DocumentState, EngineError } from "../../src/protocol";

describe("poses in numbers", () => {
  test("what has no effect is left out, and turns are kept", () => {
    const turned = withNumbers({}, { axis: [0, 1, 0], angleDeg: 720 });
    expect(turned).toEqual({ rotate: { axis: [0, 1, 0], angle_deg: 720 } });
    expect(withNumbers(turned, { translate: [1, 0, 0] })).toEqual({ ...turned, translate: [1, 0, 0] });
    expect(withNumbers(turned, { angleDeg: 0 })).toEqual({});
    expect(withNumbers({}, { scale: [2, 2, 2] })).toEqual({ scale: 2 });
    expect(withNumbers({ scale: 2 }, { scale: [1, 1, 1] })).toEqual({});
    expect(isAtRest({ pivot: [1, 2, 3] })).toBe(true);
    expect(isAtRest(turned)).toBe(false);
  });
  test("numbers of a pose, and of one that has none", () => {
    expect(numbersOf({ scale: 2 }, [1, 2, 3])).toEqual({
      translate: [0, 0, 0], axis: [0, 0, 1], angleDeg: 0, scale: [2, 2, 2], pivot: [1, 2, 3],
    });
    expect(numbersOf({ curve: [[0, 0, 0], [1, 0, 0]] }, [0, 0, 0])).toBeUndefined();
    expect(nameOfAxis([0, 3, 0])).toBe("y");
    expect(nameOfAxis([0, -1, 0])).toBe("free");
    expect(nameOfAxis([1, 1, 0])).toBe("free");
  });
});

describe("fields for numbers", () => {
  test("say what they take", () => {
    expect(rangeWords({ min: 1, max: 20 })).toBe("a number from 1 to 20");
    expect(rangeWords({ min: 1, max: 20, integer: true })).toBe("a whole number from 1 to 20");
    expect(rangeWords({ min: -Infinity, above: 0 })).toBe("a number above 0");
    expect(rangeWords({ min: 2 })).toBe("a number of at least 2");
    expect(rangeWords({})).toBe("a number");
  });
  test("take what they say", () => {
    expect([0.9, 1, 20, 20.1].map((x) => isInRange(x, { min: 1, max: 20 }))).toEqual([false, true, true, false]);
    expect([-1, 0, 1e-9].map((x) => isInRange(x, { above: 0 }))).toEqual([false, false, true]);
    expect(isInRange(-1e300, {})).toBe(true);
    expect([2.5, 3].map((x) => isInRange(x, { min: 1, max: 32, integer: true }))).toEqual([false, true]);
  });
  test("keep a turn as it was typed where it is the same", () => {
    expect(asTyped(-180, 180)).toBe(180);
    expect(asTyped(180, -180)).toBe(-180);
    expect(asTyped(0, 360)).toBe(360);
    expect(asTyped(-179, 180)).toBe(-179);
    expect(asTyped(0, 180)).toBe(0);
  });
});

describe("what the engine says of symmetry", () => {
  const refused: EngineError = {
    id: "script.no_mirror_image",
    code: "input",
    fields: { handle: "left arm", lost: 3, all: 40, first: 17, tolerance_rel: 0.033 },
    problem: "…",
    location: "handles[0]",
    step: 0,
    remedy: "…",
    notes: [],
  };
  const lacks = (fields: object) => inPanelWords({ ...refused, fields: { ...refused.fields, ...fields } }).problem;
  test("is told in the panels' words, with the tolerance that would do", () => {
    expect(sufficientTolerance(refused)).toBe(0.033);
    expect(inPanelWords(refused)).toEqual({
      problem: "3 of the 40 vertices of “left arm” lack a mirror image",
      location: "",
      remedy: expect.stringContaining("A tolerance of 3.3 %"),
    });
    expect(lacks({ lost: 40 })).toBe("all 40 vertices of “left arm” lack a mirror image");
    expect(lacks({ lost: 1 })).toBe("1 of the 40 vertices of “left arm” lacks a mirror image");
    expect(lacks({ lost: 1, all: 1 })).toBe("the vertex of “left arm” lacks a mirror image");
    const one = { ...refused, id: "script.vertex_without_mirror_image", fields: { vertex: 7, tolerance_rel: 1e-5 } };
    expect(sufficientTolerance(one)).toBe(1e-5);
    const far = { ...refused, id: "script.not_mirrored" };
    expect(sufficientTolerance(far)).toBeUndefined();
    expect(inPanelWords(far)).toMatchObject({
      problem: "3 of the 40 vertices of “left arm” lack a mirror image",
      remedy: expect.stringContaining("under Symmetry"),
    });
  });
  test("is asked again with it", () => {
    expect(withTolerance({ do: "symmetry" }, 0.1, undefined)).toEqual([{ do: "symmetry", tolerance_rel: 0.1 }]);
    const paint = { do: "paint-handle", vertices: [1] } as const;
    const plane = { point: [0, 0, 0], normal: [1, 0, 0] } as { point: [number, number, number]; normal: [number, number, number] };
    expect(withTolerance({ ...paint, vertices: [1] }, 0.1, plane)).toEqual([
      { do: "symmetry", plane, tolerance_rel: 0.1 },
      { do: "paint-handle", vertices: [1] },
    ]);
  });
});

test("names are sorted as people sort", () => {
  expect(["part 10", "b", "Part 2", "a", "B"].sort(compareNames)).toEqual(["a", "B", "b", "Part 2", "part 10"]);
});

describe("settings of the method", () => {
  const documented = readFileSync(new URL("../../../docs/edit-file.md", import.meta.url), "utf8");
  const section = documented.slice(documented.indexOf("\n## Settings"), documented.indexOf("\n### Methods"));
  test("are those of the edit file, each once", () => {
    const names = [...section.matchAll(/^\| (`[^|]*`) \|/gm)].flatMap(([, cell]) => [...(cell ?? "").matchAll(/`(\w+)`/g)].map(([, name]) => name));
    const offered = ["method", ...settingsTable.map(({ key }) => key)];
    expect(new Set(offered)).toEqual(new Set(names));
    expect(new Set(offered).size).toBe(offered.length);
  });
  test("only what applies to the method", () => {
    const keys = (method: string) => applicable({ method }).map(({ key }) => key);
    expect(keys("ft05")).not.toContain("stiffness");
    expect(keys("rotation-aware")).toContain("stiffness");
    expect(keys("rotation-aware")).not.toContain("smoothing_length_rel");
    expect(keys("corotational")).toContain("smoothing_length_rel");
    expect(keys("shell")).toEqual(keys("corotational"));
    expect(applicable({ degenerate: "apex" }).map(({ key }) => key)).not.toContain("seed");
  });
  test("back to the usual changes what is not usual, and no method", () => {
    expect(changesToDefaults({ method: "ft05", stiffness: 60, density: "ft05" })).toEqual({ density: "aware" });
  });
  test("the preset changes what is usual, and back to the usual takes it off", () => {
    const setting = (key: string) => settingsTable.find((entry) => entry.key === key);
    const published = { preset: "as-published" };
    expect(methodOf(published)).toBe("ft05");
    expect(methodOf({ ...published, method: "corotational" })).toBe("corotational");
    expect(choiceOf(published, setting("density") as ChoiceSetting)).toBe("ft05");
    expect(choiceOf({ ...published, density: "aware" }, setting("density") as ChoiceSetting)).toBe("aware");
    expect(numberOf(published, setting("laplacian_weight") as NumberSetting)).toBe(1);
    expect(numberOf({}, setting("laplacian_weight") as NumberSetting)).toBe(20);
    const keys = applicable(published).map(({ key }) => key);
    expect(keys).toContain("noise_lengths");
    for (const key of ["stiffness", "smoothing_length_rel", "apex_height_rel"]) expect(keys).not.toContain(key);
    expect(changesToDefaults(published)).toEqual({ preset: null, method: "ft05" });
    expect(changesToDefaults({ ...published, method: "corotational", seed: 3 }))
      .toEqual({ preset: null, method: "corotational", seed: 1 });
  });
  test("a choice may stand for a number", () => {
    const refine = settingsTable.find(({ key }) => key === "refine_boundary") as ChoiceSetting;
    expect([{}, { refine_boundary: "auto" }, { refine_boundary: 2 }].map((settings) => choiceOf(settings, refine)))
      .toEqual(["auto", "auto", "2"]);
    expect(refine.choices.map(({ value }) => settingOf(value))).toEqual(["auto", 0, 1, 2, 3, 4]);
    expect(changesToDefaults({ refine_boundary: 0 })).toEqual({ refine_boundary: "auto" });
  });
  test("a proxy has 50 vertices or is none", () => {
    const proxy = settingsTable.find(({ key }) => key === "proxy") as NumberSetting;
    expect([0, 3, 500].map((value) => admissible(proxy, value))).toEqual([0, 50, 500]);
  });
});

describe("the status line", () => {
  const state: DocumentState = {
    event: "state", name: "bar", up: "y", front: "-y", unit: "", edit: "", model: { name: "a", mesh: 1, loops: 0, vertices: 8, faces: 12, diagonal: 1, findings: [] }, steps: [], handles: [], groups: [],
    counts: null, settings: {}, symmetry: null, notes: [], file: "a.ply", parts: [], graft: null, selected: 0, selected_on: "a", undo: null, redo: null, set_up_for: null, dirty: false,
  };
  const set: DocumentState = {
    ...state, handles: [{ name: "a", shape: "region", pose: {} }], counts: { region: 4, fixed: 1, handle: 1, free: 2 },
  };
  test("says what to do, what is going on and what went wrong", () => {
    expect(liveWords(null, { event: "live" }).tone).toBe("idle");
    expect(liveWords(state, { event: "live" }).text).toBe("No handle yet");
    expect(liveWords(set, { event: "live", stage: "starting" }).text).toBe("Getting ready");
    expect(liveWords(set, { event: "live", stage: "ready", accuracy: "exact" }).text).toBe("Exact");
    expect(liveWords(set, { event: "live", stage: "ready", accuracy: "reduced" }).text).toBe("Quick preview");
    expect(liveWords(set, { event: "live", stage: "exact", accuracy: "exact" })).toMatchObject({ tone: "good", text: "Exact; preparing faster dragging" });
    expect(liveWords(set, { event: "live", stage: "exact", accuracy: "proxy" })).toMatchObject({ tone: "busy", text: "Preview; the exact shape follows" });
    expect(liveWords(set, { event: "live", stage: "proxy-only" }).tone).toBe("warning");
    const error: EngineError = {
      id: "deform.nothing", code: "unsolvable", fields: {}, problem: "nothing holds it", location: "", remedy: "Fix some.", notes: [],
    };
    expect(liveWords(set, { event: "live", stage: "failed", error })).toEqual({ tone: "problem", text: "Cannot be solved", explained: "Nothing holds it. Fix some." });
  });
  test("words progress by its task, or by its stage", () => {
    expect(progressWords({ stage: "factorise" })).toBe("solving the equations");
    expect(progressWords({ stage: "find_surface" })).toBe("finding the surface");
    expect(progressWords({ stage: "factorise", within: "proxy" })).toBe("making a preview");
  });
});

describe("files", () => {
  test("names and folders", () => {
    expect(baseName("/a/b/c.ply")).toBe("c.ply");
    expect(folderOf("/a/b/c.ply")).toBe("/a/b");
    expect(folderOf("/c.ply")).toBe("/");
    expect(joined("/", "c")).toBe("/c");
    expect(joined("/a", "c")).toBe("/a/c");
    expect(stemOf("/a/b.tar.ply")).toBe("b.tar");
    expect(withExtension("horse.ply", ".obj")).toBe("horse.obj");
    expect(withExtension("horse v1.2", ".obj")).toBe("horse v1.2.obj");
    expect(faultOfName("a/b")).toBeDefined();
    expect(faultOfName(" ")).toBeDefined();
    expect(faultOfName("a b")).toBeUndefined();
  });
  test("what is too big, empty or no model is refused before it is sent", () => {
    expect(refusalOf({ name: "a.PLY", size: 10 })).toBeUndefined();
    expect(refusalOf({ name: "a.ply", size: uploadLimit })).toBeUndefined();
    expect(refusalOf({ name: "a.ply", size: uploadLimit + 1 })?.remedy).toContain("Add its folder");
    expect(refusalOf({ name: "a.ply", size: 0 })?.problem).toContain("empty");
    expect(refusalOf({ name: "a.json", size: 10 })?.problem).toContain("edit file");
    expect(refusalOf({ name: "a.blend", size: 10 })?.remedy).toContain(".ply");
  });
  test("the limit is the server's", () => {
    const server = readFileSync(new URL("../../../src/server/server.h", import.meta.url), "utf8");
    expect(server).toContain("upload_limit = std::uint64_t{1} << 30");
    expect(uploadLimit).toBe(2 ** 30);
  });
});

describe("sliders", () => {
  test.each([
    [0, 10, false], [0, 1e4, true], [0.01, 5, true],
  ])("from %d to %d go there and back", (low, high, logarithmic) => {
    const track = new Track(low, high, logarithmic);
    expect(track.value(0)).toBe(low);
    expect(track.value(1)).toBeCloseTo(high, 6);
    for (const position of [0.1, 0.5, 0.9]) expect(track.position(track.value(position))).toBeCloseTo(position, 9);
    expect(track.position(2 * high)).toBe(1);
    expect(track.position(low - 1)).toBe(0);
  });
});

describe("the plane of symmetry", () => {
  const box: Box = { low: [-1, 0, 2], high: [3, 4, 10] };
  test("lies across an axis, in the middle at first", () => {
    expect(planeAcross("x", box)).toEqual({ point: [1, 2, 6], normal: [1, 0, 0] });
    expect(coordinateOf(planeAcross("z", box, 7), "z")).toBe(7);
    expect(axisOfPlane({ point: [0, 0, 0], normal: [0, -2, 0] })).toBe("y");
    expect(axisOfPlane({ point: [0, 0, 0], normal: [1, 1, 0] })).toBeUndefined();
  });
});

test("colours of handles are told apart, and groups take what is free", () => {
  expect(new Set([0, 1, 2, 3].map(handleColour)).size).toBe(4);
  const first = groupColour([]);
  expect(groupColour([first])).not.toBe(first);
});

describe("messages", () => {
  const about = (problem: string, more: Partial<Message> = {}): Message => ({
    key: 0, kind: "problem", told: { problem, location: "", remedy: "" }, ...more,
  });
  const problems = (all: readonly Message[]) => withAll(all).map(({ told }) => told.problem);
  const withAll = (all: readonly Message[]) => all.reduce<readonly Message[]>(withMessage, []);
  test("replace an earlier one on the same topic or of the same request", () => {
    expect(problems([about("a", { topic: "written" }), about("b", { topic: "written" })])).toEqual(["b"]);
    expect(problems([about("a", { of: "graft" }), about("b", { of: "graft" })])).toEqual(["b"]);
    expect(problems([about("a", { of: "graft" }), about("b", { of: "save" })])).toEqual(["a", "b"]);
  });
  test("that say the same are shown once, and others stand beside each other", () => {
    expect(problems([about("a"), about("a", { of: "graft" }), about("b")])).toEqual(["a", "b"]);
  });
});

describe("the holes that a repair fills", () => {
  test("are named by their number of edges", () => {
    expect([undefined, "auto", 0, 12, 100_000].map(holesOf)).toEqual(["auto", "auto", "none", "some", "all"]);
    for (const choice of ["none", "auto", "some", "all"] as const) expect(holesOf(holeEdgesOf(choice))).toBe(choice);
  });
});
