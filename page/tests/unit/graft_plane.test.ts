import { Vector3 } from "three";
import { expect, test } from "vitest";
import { planeThroughLine, runsLeft } from "../../src/tools/graft/graft_plane_math";

const v = (x: number, y: number, z: number) => new Vector3(x, y, z);

test("lays a plane through a line across the view; above is at its left hand", () => {
  // The view is along -z with y up, so the left-hand side of a line to the right is up.
  const plane = planeThroughLine(v(0, 0, 1), v(2, 0, 1), v(0, 0, -1), v(0, 0, -1));
  expect(plane?.point.toArray()).toEqual([1, 0, 1]);
  expect(plane?.normal.y).toBeCloseTo(1);
  expect(planeThroughLine(v(1, 1, 1), v(1, 1, 1), v(0, 0, -1), v(0, 0, -1))).toBeUndefined();
});

test("tells which way a stroke runs on the page", () => {
  expect(runsLeft([[0, 0], [0, 10], [10, 10], [10, 0]])).toBe(true); // down, right, up: counter-clockwise as seen
  expect(runsLeft([[0, 0], [10, 0], [10, 10], [0, 10]])).toBe(false);
});
