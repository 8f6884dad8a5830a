import { expect, test } from "vitest";
import { standBeside, type Box, type Standing } from "../../src/view/beside";

const cube = (size: number, at: [number, number, number] = [0, 0, 0]): Box => ({
  min: at,
  max: [at[0] + size, at[1] + size, at[2] + size],
});
const shown = ({ min, max }: Box, { scale, offset }: Standing) =>
  [0, 1, 2].map((k) => [scale * (min[k] as number) + (offset[k] as number), scale * (max[k] as number) + (offset[k] as number)]);

test("puts parts in a row that does not overlap, at the height of the model's middle", () => {
  const model = cube(2, [-1, -1, 5]);
  const parts = [cube(1, [9, 9, 9]), cube(3)];
  const [a, b] = standBeside(model, parts).map((standing, i) => shown(parts[i] as Box, standing));
  expect(a?.[0]?.[0]).toBeGreaterThan(1);
  expect(b?.[0]?.[0]).toBeGreaterThan(a?.[0]?.[1] as number);
  for (const box of [a, b]) expect(((box?.[2]?.[0] ?? 0) + (box?.[2]?.[1] ?? 0)) / 2).toBeCloseTo(6);
});

test("shows a part of quite another size in the model's size", () => {
  const [tiny, alike] = standBeside(cube(100), [cube(0.5), cube(60)]);
  expect(tiny?.scale).toBeCloseTo(200);
  expect(alike?.scale).toBe(1);
});

test("bears a part without extent", () => {
  expect(standBeside(cube(1), [cube(0)])[0]?.scale).toBe(1);
});
