import { expect, test } from "vitest";
import { layOutParts, type PartBox, type Box, type PartTransform } from "../../src/view/graft/part_layout";

const cube = (size: number, at: [number, number, number] = [0, 0, 0]): Box => ({
  min: at,
  max: [at[0] + size, at[1] + size, at[2] + size],
});
const alongX = (box: Box): PartBox => ({ ...box, towards: [1, 0, 0] });
const shown = ({ min, max }: Box, { scale, offset }: PartTransform) =>
  [0, 1, 2].map((k) => [scale * (min[k] as number) + (offset[k] as number), scale * (max[k] as number) + (offset[k] as number)]);

test("puts parts in a row that does not overlap, at the height of the model's middle", () => {
  const model = cube(2, [-1, -1, 5]);
  const parts = [cube(1, [9, 9, 9]), cube(3)];
  const [a, b] = layOutParts(model, parts.map(alongX)).map((transform, i) => shown(parts[i] as Box, transform));
  expect(a?.[0]?.[0]).toBeGreaterThan(1);
  expect(b?.[0]?.[0]).toBeGreaterThan(a?.[0]?.[1] as number);
  for (const box of [a, b]) expect(((box?.[2]?.[0] ?? 0) + (box?.[2]?.[1] ?? 0)) / 2).toBeCloseTo(6);
});

test("puts a part beyond all others in its direction, whatever that is", () => {
  const model: Box = { min: [-1, -4, 5], max: [1, 4, 6] };
  const towards: [number, number, number][] = [[0.6, 0.8, 0], [0, 0, -1], [-0.6, 0, 0.8], [0.6, 0.8, 0]];
  const parts = towards.map((to, i): PartBox => ({ ...cube(i + 1, [7, 8, i]), towards: to }));
  const boxes = [model, ...layOutParts(model, parts).map((transform, i) => {
    const sides = shown(parts[i] as Box, transform) as [number, number][];
    return { min: sides.map(([low]) => low), max: sides.map(([, high]) => high) };
  })];
  // Along its direction, a box begins beyond all earlier ones.
  towards.forEach((to, i) => {
    const along = ({ min, max }: { min: readonly number[]; max: readonly number[] }) => [
      to.reduce((sum, x, k) => sum + Math.min(x * (min[k] as number), x * (max[k] as number)), 0),
      to.reduce((sum, x, k) => sum + Math.max(x * (min[k] as number), x * (max[k] as number)), 0),
    ] as const;
    const [begins] = along(boxes[i + 1]!);
    for (const before of boxes.slice(0, i + 1)) expect(begins).toBeGreaterThan(along(before)[1]);
  });
});

test("shows a part of quite another size in the model's size", () => {
  const [tiny, alike] = layOutParts(cube(100), [cube(0.5), cube(60)].map(alongX));
  expect(tiny?.scale).toBeCloseTo(200);
  expect(alike?.scale).toBe(1);
});

test("bears a part without extent", () => {
  expect(layOutParts(cube(1), [alongX(cube(0))])[0]?.scale).toBe(1);
});
