import { afterEach, expect, test } from "vitest";
import { EditorHarness, theme } from "./harness";

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
});

test("what is shaped on one side is shaped on the other with symmetry, and what moves nothing says so", async () => {
  harness = await EditorHarness.open({ dark: true });
  await harness.openSample("bar", 20);
  const { user } = harness;
  const { page } = user;
  const widthOf = (positions: Float64Array, side: 1 | -1) => Math.max(...positions.filter((_, at) => at % 3 === 0).map((x) => side * x));
  const before = await harness.savedPositions();
  await user.press("y");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry != null);
  await page.evaluate(async () => {
    const sphere = { centre: [0.5, 0, 1] as [number, number, number], radius: 0.45 };
    await window.meshgraft.editor.ask({ do: "select", how: "set", what: { sphere } });
  });
  const line = page.getByRole("toolbar", { name: "Shape" });
  await line.getByRole("button", { name: "Flatten" }).click(); // it is flat
  await page.getByRole("log", { name: "Messages" }).getByText("Nothing moved").waitFor();
  await user.rests();
  await user.screenshot("shaping-nothing");
  await line.getByRole("button", { name: "Inflate" }).click();
  await user.rests();
  await user.screenshot("shaping-symmetric");
  const after = await harness.savedPositions();
  expect(widthOf(after, 1)).toBeGreaterThan(widthOf(before, 1) + 0.05);
  expect(widthOf(after, -1)).toBeCloseTo(widthOf(after, 1), 5);
  const kinds = () => page.evaluate(() => window.meshgraft.editor.state.value?.steps.map(({ kind }) => kind));
  expect(await kinds()).toEqual(["sculpt", "sculpt", "deform"]); // one for each click
  await user.press("Control+z");
  await user.settle();
  expect(widthOf(await harness.savedPositions(), -1)).toBeCloseTo(widthOf(before, -1), 6);
  expect(user.complaints).toEqual([]);
});

test("the surface around what is shaped follows within a reach, which the step keeps", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bar", 20);
  const { user } = harness;
  const { page } = user;
  const before = await harness.savedPositions();
  const moved = async () => {
    const after = await harness!.savedPositions();
    return before.filter((_, at) => at % 3 === 0 && Math.hypot(...[0, 1, 2].map((k) => after[at + k]! - before[at + k]!)) > 1e-6).length;
  };
  await page.evaluate(async () => {
    const sphere = { centre: [0.5, 0, 2] as [number, number, number], radius: 0.3 };
    await window.meshgraft.editor.ask({ do: "select", how: "set", what: { sphere } });
  });
  const line = page.getByRole("toolbar", { name: "Shape" });
  await line.getByRole("button", { name: "Inflate" }).click();
  await user.rests();
  const inside = await moved();
  await user.press("Control+z");
  await user.rests();
  await line.getByText("Around").click();
  const reach = line.getByRole("textbox", { name: "Reach" });
  await reach.fill("0.4");
  await reach.press("Enter");
  await line.getByRole("button", { name: "Inflate" }).click();
  await user.rests();
  await user.screenshot(`shaping-around-${theme}`);
  const around = await moved();
  expect(around).toBeGreaterThan(inside);

  await page.getByRole("button", { name: "Steps", exact: false }).first().click();
  await page.getByRole("button", { name: "1. Shape" }).first().click();
  const details = page.getByRole("list", { name: "Steps" });
  const later = details.getByRole("textbox", { name: "Reach" });
  expect(await later.inputValue()).toBe("0.4");
  await later.fill("0.8");
  await later.press("Enter");
  await user.rests();
  await user.screenshot(`shaping-reach-${theme}`);
  expect(await moved()).toBeGreaterThan(around);
  await later.fill("-1");
  await later.press("Enter");
  await page.getByText("Enter a number of at least 0.").waitFor();
  await later.press("Escape");
  await details.getByText("Inside").click();
  await user.rests();
  expect(await moved()).toBe(inside);
  expect(user.complaints).toEqual([]);
});
