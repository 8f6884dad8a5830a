import { Vector3 } from "three";
import { expect, test } from "vitest";
import { flipped, movedBy, nearestAlong, onBall, planeThroughLine, runsLeft, tiltedTo } from "../../src/tools/graft/graft_plane_math";

const v = (x: number, y: number, z: number) => new Vector3(x, y, z);

test("lays a plane through a line across the view; above is at its left hand", () => {
  // The view is along -z with y up, so the left-hand side of a line to the right is up.
  const plane = planeThroughLine(v(0, 0, 1), v(2, 0, 1), v(0, 0, -1), v(0, 0, -1));
  expect(plane?.point.toArray()).toEqual([1, 0, 1]);
  expect(plane?.normal.y).toBeCloseTo(1);
  expect(planeThroughLine(v(1, 1, 1), v(1, 1, 1), v(0, 0, -1), v(0, 0, -1))).toBeUndefined();
});

test("moves, tilts and turns a plane over", () => {
  const plane = { point: v(0, 0, 1), normal: v(0, 0, 1) };
  expect(movedBy(plane, 2).point.z).toBe(3);
  expect(tiltedTo(plane, v(3, 0, 1)).normal.toArray()).toEqual([1, 0, 0]);
  expect(tiltedTo(plane, v(0, 0, 1))).toBe(plane);
  expect(flipped(plane).normal.z).toBe(-1);
});

test("finds where a ray passes a line", () => {
  expect(nearestAlong(v(0, 0, 0), v(0, 0, 1), v(5, 0, 2), v(-1, 0, 0))).toBeCloseTo(2);
  expect(nearestAlong(v(0, 0, 0), v(0, 0, 1), v(5, 0, 2), v(0, 0, 1))).toBeUndefined();
});

test("keeps a tip on its sphere, also for a ray that misses it", () => {
  expect(onBall(v(0, 0, 0), 1, v(0, 0, 5), v(0, 0, -1)).z).toBeCloseTo(1);
  expect(onBall(v(0, 0, 0), 1, v(3, 0, 5), v(0, 0, -1)).toArray()).toEqual([1, 0, 0]);
});

test("tells which way a stroke runs on the page", () => {
  expect(runsLeft([[0, 0], [0, 10], [10, 10], [10, 0]])).toBe(true); // down, right, up: counter-clockwise as seen
  expect(runsLeft([[0, 0], [10, 0], [10, 10], [0, 10]])).toBe(false);
});
