import { expect, test } from "vitest";
import { kindOf } from "../../src/app/pointer_kind";
import { brushRadiusAt } from "../../src/tools/tool";

test("the radius of the brush grows with the pressure of a pen, within limits", () => {
  const radius = (pressure?: number) => brushRadiusAt(24, { pressure });
  expect(radius()).toBe(24);
  expect(radius(0.5)).toBe(24);
  expect(radius(0.25)).toBe(12);
  expect(radius(0)).toBeGreaterThan(0);
  expect(radius(1)).toBeLessThan(2 * 24);
});

test("only fingers and pens count as such", () => {
  expect(["mouse", "touch", "pen", ""].map(kindOf)).toEqual(["mouse", "touch", "pen", "mouse"]);
});
