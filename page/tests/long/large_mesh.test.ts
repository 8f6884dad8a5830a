import { writeFileSync } from "node:fs";
import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, positionsOf } from "../e2e/harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

/** Returns the OBJ text of a hilly sheet of n × n squares, two triangles each. */
function sheet(n: number): string {
  const lines: string[] = [];
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= n; ++i) lines.push(`v ${i} ${j} ${(8 * Math.sin(i / 40) * Math.cos(j / 30)).toFixed(4)}`);
  for (let j = 0; j < n; ++j)
    for (let i = 0; i < n; ++i) {
      const v = j * (n + 1) + i + 1;
      lines.push(`f ${v} ${v + 1} ${v + n + 2}`, `f ${v} ${v + n + 2} ${v + n + 1}`);
    }
  return lines.join("\n") + "\n";
}

test("a mesh that comes in parts is whole", async () => {
  const n = 420; // more than 8 MiB, so the mesh comes in parts
  const { folder, user } = harness;
  const file = folder.file("sheet.obj");
  writeFileSync(file, sheet(n));
  const positions = positionsOf(file);

  await user.page.evaluate((path) => window.meshgraft.editor.ask({ do: "open", path }), file);
  await user.page.waitForFunction(() => window.meshgraft.viewport.main?.object.parent != null);
  const shown = await user.page.evaluate(async () => {
    const { viewport } = window.meshgraft;
    const surface = viewport.main;
    if (surface === undefined) throw new Error("nothing is shown");
    const { offset, triangles } = surface;
    return { positions: [...(await viewport.readPositions())], offset: [...offset], triangles: [...triangles] };
  });
  expect(shown.positions).toHaveLength(positions.length);
  const furthest = shown.positions.reduce(
    (most, x, i) => Math.max(most, Math.abs(x + (shown.offset[i % 3] as number) - (positions[i] as number))), 0);
  expect(furthest).toBeLessThan(1e-4);
  expect(shown.triangles).toHaveLength(6 * n * n);
  const isRight = shown.triangles.every((v, i) => {
    const square = Math.floor(i / 6);
    const first = Math.floor(square / n) * (n + 1) + (square % n);
    return v === first + ([0, 1, n + 2, 0, n + 2, n + 1][i % 6] as number);
  });
  expect(isRight).toBe(true);
  expect(user.complaints).toEqual([]);
});
