import { afterEach, expect, test } from "vitest";
import { close, grafted, graftOf, open, saved, watertight } from "./grafting";
import type { User } from "./harness";

afterEach(close);

type Rows = readonly (readonly number[])[];

/** Maps a point by the rows of a 4×4 matrix. */
function mapped(rows: Rows, point: readonly number[]): number[] {
  return rows.slice(0, 3).map((row) => (row[3] ?? 0) + point.reduce((sum, x, k) => sum + x * (row[k] ?? 0), 0));
}

/** Expects that a map places points at the mirror images of where another one does, at a plane across an axis. */
function expectMirrored(second: Rows, first: Rows, axis: number, coordinate: number, within: number): void {
  for (const point of [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
    const expected = mapped(first, point);
    expected[axis] = 2 * coordinate - (expected[axis] as number);
    mapped(second, point).forEach((x, k) => expect(Math.abs(x - (expected[k] as number))).toBeLessThan(within));
  }
}

async function accept(user: User): Promise<void> {
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
}

test("a dropped part gets a mirrored copy on the other side in one act", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("torus", 40);
  await page.getByRole("tab", { name: "Graft" }).click();
  await page.evaluate(async () => {
    const { editor, viewport } = window.meshgraft;
    await editor.graft.addPart({ sample: "head", resolution: 20 }, false);
    const { positions, offset, vertexCount } = viewport.main!;
    const at = (v: number) => [0, 1, 2].map((k) => (positions[3 * v + k] ?? 0) + (offset[k] ?? 0)) as [number, number, number];
    const score = (v: number) => at(v)[0] + 0.4 * at(v)[1] + 0.8 * at(v)[2];
    const best = Array.from({ length: vertexCount }, (_, v) => v).reduce((a, b) => (score(b) > score(a) ? b : a));
    await editor.graft.set({ source: "head", at: { point: at(best), spin_deg: 25 }, size: 0.25 });
  });
  const first = (await grafted(user))?.transform;
  await accept(user);
  await user.click("More for head");
  await user.screenshot("graft-mirrored-menu");
  await page.getByRole("menuitem", { name: "Mirrored copy" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft != null);
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  expectMirrored(report?.transform ?? [], first ?? [], 0, 0, 1e-3);
  await user.rests();
  await user.screenshot("graft-mirrored");
  await accept(user);
  expect(await saved(harness)).toMatchObject(watertight);
  await user.press("Control+z");
  await user.press("Control+z");
  await user.settle();
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.steps.length)).toBe(2); // the first graft, and the work after it
  expect(user.complaints).toEqual([]);
}, 180_000);

test("a part at a loop gets a mirrored copy at the loop on the other side, or says that there is none", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("cylinder", 24);
  await page.getByRole("tab", { name: "Graft" }).click();
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.graft.addPart({ sample: "head", resolution: 20 }, false);
    await editor.graft.set({ source: "head", pairs: [{ source_loop: { loop: 0 }, target_loop: { loop: 0 } }] });
  });
  const first = (await grafted(user))?.transform;
  await accept(user);
  const mirrors = async () => {
    await user.click("More for head");
    await page.getByRole("menuitem", { name: "Mirrored copy" }).click();
  };
  await mirrors(); // between left and right, where there is no loop
  await page.getByText("the model has no open loop where the mirrored copy would be").waitFor();
  expect(await graftOf(user)).toBeNull();
  const middle = 2; // of the cylinder, which is 4 high
  await page.evaluate(
    (z) => window.meshgraft.editor.ask({ do: "symmetry", plane: { point: [0, 0, z], normal: [0, 0, 1] }, tolerance_rel: 1 }),
    middle,
  );
  await mirrors();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft != null);
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  expect(await page.getByText("no open loop where the mirrored copy would be").count()).toBe(0);
  expectMirrored(report?.transform ?? [], first ?? [], 2, middle, 0.05); // a degree of the head, although the vertices of the other end lie half an edge further
  await user.rests();
  await user.screenshot("graft-mirrored-loop");
  await accept(user);
  expect(await saved(harness)).toMatchObject(watertight);
  expect(user.complaints).toEqual([]);
}, 180_000);
