import { expect, test } from "vitest";
import { areInOrder, between, LoopCurve, matchingParameter, nearestPoint, twistDeg, twisted } from "../../src/app/graft/loop_curve";

/** Returns a circle of n vertices, numbered from `first` on; `sense` -1 runs clockwise. */
function circle(n: number, sense: 1 | -1, first = 0): LoopCurve {
  const positions = new Float32Array(3 * (first + n));
  for (let i = 0; i < n; ++i) {
    const angle = (sense * 2 * Math.PI * i) / n;
    positions.set([Math.cos(angle), Math.sin(angle), 0], 3 * (first + i));
  }
  return new LoopCurve(Uint32Array.from({ length: n }, (_, i) => first + i), positions);
}

test("measures a loop by its length", () => {
  const loop = circle(8, 1, 3);
  expect(loop.length).toBeCloseTo(16 * Math.sin(Math.PI / 8), 5);
  expect(loop.parameterOf(5)).toBeCloseTo(0.25);
  expect(loop.parameterOf(0)).toBeUndefined();
  expect(loop.vertexAt(0.99)).toBe(3);
  expect(loop.vertexAt(0.51)).toBe(7);
  expect(between(0.9, 0.1)).toBeCloseTo(0.2);
});

test("matches loops that run opposite ways", () => {
  const source = circle(12, 1);
  const target = circle(24, -1);
  expect(target.vertexAt((matchingParameter(source, target, [0, 0], 3) ?? 0) + 1)).toBe(18);
});

test.each([0, 5, -30, 90, 170])("turns a start by %d° and tells that angle", (angle) => {
  const source = circle(20, 1);
  const target = circle(24, -1);
  const start = twisted(source, target, [2, 3], angle);
  // Starts of 20 and 24 vertices differ in steps of 3°, so the nearest is within 1.5°.
  expect(Math.abs(twistDeg(source, target, [2, 3], start) - angle)).toBeLessThanOrEqual(1.5 + 1e-3);
});

test("leaves a start alone at no turn", () => {
  expect(twisted(circle(20, 1), circle(24, -1), [2, 3], 0)).toEqual([2, 3]);
});

test("tells what crosses", () => {
  const source = circle(12, 1);
  const target = circle(12, -1);
  expect(areInOrder(source, target, [[0, 0], [3, 9], [6, 6]])).toBe(true);
  expect(areInOrder(source, target, [[0, 0], [3, 3], [6, 6]])).toBe(false);
  expect(areInOrder(source, target, [[0, 0], [3, 9], [6, 9]])).toBe(false);
  expect(areInOrder(source, target, [])).toBe(true);
});

test("finds the nearest point on the page", () => {
  expect(nearestPoint([0, 0, 10, 0, 10, 10], 9, 2)).toEqual({ index: 1, distance: Math.sqrt(5) });
  expect(nearestPoint([], 0, 0).index).toBe(-1);
});
