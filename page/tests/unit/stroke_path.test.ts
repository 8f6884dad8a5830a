import { describe, expect, test } from "vitest";
import { StrokePath } from "../../src/tools/stroke_path";
import { brushRadiusAt } from "../../src/tools/tool";

describe("the path of a brush", () => {
  test.each([0.05, 0.2, 0.5, 1])("leaves no gap with a pen that presses by %s", (pressure) => {
    const radius = brushRadiusAt(24, { pressure });
    const path = new StrokePath({ x: 0, y: 0 });
    const points = [{ x: 0, y: 0 }, { x: 7, y: 0 }, { x: 200, y: 0 }, { x: 200, y: 150 }].flatMap((to) => path.to(to, 0.5 * radius));
    expect(points[0]).toEqual({ x: 0, y: 0 });
    points.slice(1).forEach(({ x, y }, i) => {
      const before = points[i] as { x: number; y: number };
      expect(Math.hypot(x - before.x, y - before.y)).toBeLessThanOrEqual(radius);
    });
    const last = points.at(-1) as { x: number; y: number };
    expect(Math.hypot(200 - last.x, 150 - last.y)).toBeLessThanOrEqual(radius);
  });
  test("follows a pressure that falls along the way", () => {
    const path = new StrokePath({ x: 0, y: 0 });
    path.to({ x: 100, y: 0 }, 20);
    const light = path.to({ x: 200, y: 0 }, 4);
    expect(light.length).toBeGreaterThan(24);
    expect(light[0]?.x).toBeLessThan(105);
  });
});
