import { Quaternion, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { layingPose, scalingPose } from "../../src/app/placing";
import { printLines, printProblems, unitOfFileWords, type PrintCheck } from "../../src/app/print_words";

const sound: PrintCheck = {
  size: [120, 80, 45], area: 200, volume: 32_000, inside_out: false, holes: 0, open_edges: 0, non_manifold_edges: 0, turned_edges: 0,
  intersections: 0, thinnest_wall: 2, thin: 4, overhanging: 0, overhang_area: 0,
};
const limits = { leastWall: 1, overhangDeg: 45, unit: "mm" } as const;
const wordsOf = (check: Partial<PrintCheck>) => printLines({ ...sound, ...check }, limits).map(({ words }) => words);

describe("the lines of a print check", () => {
  test("of a sound model are good, and tell its size", () => {
    expect(wordsOf({})).toEqual([
      "Closed", "All faces face the same way", "No self-intersections", "Thinnest wall 2 mm", "No overhangs beyond 45°",
      "Size 120 × 80 × 45 mm", "Volume 32000 mm³",
    ]);
    expect(printProblems(sound, limits)).toEqual([]);
  });
  test("tell what print shops refuse, with its place and its remedy", () => {
    const broken = { ...sound, holes: 2, open_edges: 31, non_manifold_edges: 1, turned_edges: 3, intersections: 286, volume: null };
    const problems = printProblems(broken, limits);
    expect(problems.map(({ words }) => words)).toEqual([
      "Open: 2 holes", "1 non-manifold edge, with more than two faces", "3 edges between faces that face opposite ways",
      "286 self-intersecting pairs of faces: print shops refuse this",
    ]);
    expect(problems.every(({ tone }) => tone === "bad")).toBe(true);
    expect(problems.map(({ finding }) => finding)).toEqual(["open-edges", "non-manifold-edges", "turned-edges", "intersections"]);
    expect(problems.map(({ remedy }) => remedy)).toEqual(["close-holes", "split", "turn", undefined]);
    expect(wordsOf({ volume: null }).at(-1)).toBe("Size 120 × 80 × 45 mm");
    expect(wordsOf({ inside_out: true })).toContain("Inside out");
  });
  test("warn of thin walls and overhangs", () => {
    const lines = printProblems({ ...sound, thinnest_wall: 0.4, overhanging: 9, overhang_area: 25 }, limits);
    expect(lines).toEqual([
      { tone: "warning", words: "Thinnest wall 0.4 mm, below 1 mm", finding: "thin-walls" },
      { tone: "warning", words: "12.5 % of the surface overhangs beyond 45°: it needs supports", finding: "overhangs" },
    ].map((line) => ({ ...line, words: line.words.replace("12.5", "13") })));
    expect(wordsOf({ thinnest_wall: null })).not.toContain("Thinnest wall 2 mm");
  });
});

test("an export names the unit of its file, and warns if that is not the view's", () => {
  expect(unitOfFileWords(".3mf", "", "mm")).toEqual({ words: "The file says mm.", isOther: false });
  expect(unitOfFileWords(".3mf", "inch", "cm").isOther).toBe(true);
  expect(unitOfFileWords(".glb", "meter", "mm")).toEqual({
    words: "The file says m, and the view shows mm: scale the model first.", isOther: true,
  });
  expect(unitOfFileWords(".stl", "", "in").isOther).toBe(true);
  expect(unitOfFileWords(".stl", "", "mm").isOther).toBe(false);
  expect(unitOfFileWords(".ply", "", "in")).toEqual({ words: "The file names no unit; its numbers are in.", isOther: false });
  expect(unitOfFileWords(".ply", "", "none").words).toContain("no unit");
});

describe("the pose of a model", () => {
  test("scales about the middle of its foot", () => {
    expect(scalingPose(2, { low: [0, 2, -4], high: [2, 6, 8] }, [0, 0, 1])).toEqual({ scale: 2, pivot: [1, 4, -4] });
    expect(scalingPose(2, { low: [0, 2, -4], high: [2, 6, 8] }, [0, 1, 0])).toEqual({ scale: 2, pivot: [1, 2, 2] });
  });
  test.each([
    [[1, 0, 0]], [[0, 0, -1]], [[0, 0, 1]], [[1, 2, -3]],
  ])("lays the face with the normal %j on the bed", (normal) => {
    const corners = Float32Array.from([1, 1, 1, -1, 1, 2, 0.5, -2, 0, 0, 0, -3]);
    const offset = [10, 20, 30];
    const { translate = [0, 0, 0], rotate, pivot = [0, 0, 0] } = layingPose(new Vector3(...(normal as [number, number, number])), new Vector3(0, 0, 1), corners, offset);
    const turn = new Quaternion();
    if (rotate !== undefined) turn.setFromAxisAngle(new Vector3(...rotate.axis), (rotate.angle_deg * Math.PI) / 180);
    const down = new Vector3(...(normal as [number, number, number])).normalize().applyQuaternion(turn);
    expect(down.distanceTo(new Vector3(0, 0, -1))).toBeLessThan(1e-6);
    expect(pivot).toEqual(offset);
    const heights = [0, 3, 6, 9].map(
      (at) => new Vector3().fromArray(corners, at).applyQuaternion(turn).z + 30 + (translate[2] ?? 0),
    );
    expect(Math.min(...heights)).toBeCloseTo(0, 6);
    expect([translate[0], translate[1]].map((shift) => Math.abs(shift ?? 0))).toEqual([0, 0]);
  });
});
