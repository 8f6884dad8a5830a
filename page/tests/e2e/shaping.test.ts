import { afterEach, expect, test } from "vitest";
import { EditorHarness } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Returns the largest height of the positions. */
function topOf(positions: Float64Array): number {
  return Math.max(...positions.filter((_, at) => at % 3 === 2));
}

test("what is selected is inflated and smoothed by a click each, and undo takes it back", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bar", 20);
  const { user } = harness;
  const { page } = user;
  const before = topOf(await harness.savedPositions());
  await page.evaluate(async () => {
    const plane = { point: [0, 0, 3.2], normal: [0, 0, 1] };
    await window.meshgraft.editor.ask({ do: "select", how: "set", what: { half_space: plane } });
  });
  const line = page.getByRole("toolbar", { name: "Shape" });
  await line.getByRole("button", { name: "Inflate" }).click();
  await user.rests();
  await user.screenshot("shaping-inflated");
  const inflated = topOf(await harness.savedPositions());
  expect(inflated).toBeGreaterThan(before + 0.05);
  await line.getByRole("button", { name: "Smooth" }).click();
  await user.rests();
  await user.screenshot("shaping-smoothed");
  const smoothed = topOf(await harness.savedPositions());
  expect(smoothed).not.toBeCloseTo(inflated, 3);

  await page.getByRole("button", { name: "Steps", exact: false }).first().click();
  await page.getByRole("button", { name: "2. Shape" }).first().click();
  const strength = page.getByRole("list", { name: "Steps" }).getByRole("textbox", { name: "Smooth" });
  await strength.fill("0");
  await strength.press("Enter");
  await user.rests();
  expect(topOf(await harness.savedPositions())).toBeCloseTo(inflated, 6);
  for (let k = 0; k < 3; ++k) await user.press("Control+z");
  await user.settle();
  expect(topOf(await harness.savedPositions())).toBeCloseTo(before, 6);
  expect(user.complaints).toEqual([]);
}, 120_000);
