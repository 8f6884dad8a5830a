import { expect, test } from "vitest";
import { mostPlaneTiltDeg, normalOfTilt, tiltOf } from "../../src/app/graft/plane_tilt";
import type { Vector3Tuple } from "../../src/app/graft/graft_step";

test("an axis has no tilt, and a tilted normal leans by its angle", () => {
  expect(tiltOf([0, 0, 1], 2)).toEqual({ axis: 2, isAlong: true, degrees: [0, 0] });
  const leaning = normalOfTilt({ axis: 2, isAlong: true, degrees: [30, 0] }); // from z towards x
  expect(leaning[0]).toBeCloseTo(0.5);
  expect(leaning[1]).toBeCloseTo(0);
  expect(leaning[2]).toBeCloseTo(Math.sqrt(0.75));
});

test.each([
  [[0.2, -0.4, 0.8]],
  [[-0.6, 0.1, -0.3]],
  [[1, 0, 0]],
  [[-0.001, 0.9, 0.2]],
] satisfies [Vector3Tuple][])("the tilt of %j leads back to it from every axis", (given) => {
  const length = Math.hypot(...given);
  for (const axis of [0, 1, 2] as const) {
    const tilt = tiltOf(given, axis);
    expect(Math.max(...tilt.degrees.map(Math.abs))).toBeLessThanOrEqual(mostPlaneTiltDeg + 1e-6);
    normalOfTilt(tilt).forEach((x, k) => expect(x).toBeCloseTo(given[k]! / length, 9));
  }
});

test("the axis stays while the plane leans from it", () => {
  expect(tiltOf(normalOfTilt({ axis: 2, isAlong: false, degrees: [60, -20] }), 2)).toMatchObject({ axis: 2, isAlong: false });
  expect(tiltOf([1, 0, 0.01], 2).axis).toBe(0);
});
