import { mkdirSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { EditorHarness, run, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Presses tab until an element of this name has the focus. */
async function tabTo(user: User, name: RegExp): Promise<void> {
  for (let i = 0; i < 80; ++i) {
    const label = await user.page.evaluate(
      () => document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? "",
    );
    if (name.test(label)) return;
    await user.page.keyboard.press("Tab");
  }
  throw new Error(`tab does not come to ${name}`);
}

async function grafted(user: User): Promise<void> {
  await user.page.waitForFunction(
    () => {
      const { editor } = window.meshgraft;
      const { report } = editor.graft;
      const graft = editor.state.value?.graft?.graft;
      return (
        editor.isIdle() &&
        graft !== undefined &&
        report.value?.graft === graft &&
        report.value.seam !== undefined
      );
    },
    undefined,
    { timeout: 60_000 },
  );
}

test("a part of a folder is grafted and accepted by keys, and swapped, in the dark theme", async () => {
  harness = await EditorHarness.open({ dark: true, models: { "bust.ply": ["bust", "--resolution", "40"] } });
  const { user, folder } = harness;
  const { page } = user;
  mkdirSync(folder.file("parts"));
  for (const name of ["head", "cylinder", "knot"])
    run("sample", name, "--resolution", "40", "-o", folder.file(`parts/${name}.ply`));
  await page.reload(); // the new page sees the new folder
  await user.opened();
  await tabTo(user, /^Deform$/);
  await user.press("ArrowRight");
  await page.waitForFunction(() => window.meshgraft.editor.graft.mode.value === "graft");

  await tabTo(user, /^Where parts come from$/);
  await user.press("ArrowDown");
  await page.getByRole("button", { name: /parts$/ }).waitFor();
  await tabTo(user, /parts$/);
  await user.press("Enter");
  await page.getByRole("button", { name: "Add knot" }).waitFor();
  await page.waitForFunction(
    () => document.querySelectorAll('[aria-label="parts"] img.thumbnail').length === 3,
  );
  await user.screenshot("graft-folder-dark");
  await tabTo(user, /^Add head$/);
  await user.press("Enter");
  await grafted(user);
  await user.screenshot("graft-dark");
  const step = () => page.evaluate(() => window.meshgraft.editor.graft.kept.value);
  expect(await step()).toMatchObject({ source: "head", target: "bust" });

  await page.getByText("More options").click();
  await user.click("Swap part and model");
  await page.waitForFunction(() => window.meshgraft.editor.graft.kept.value?.source === "bust");
  await grafted(user);
  expect(await step()).toMatchObject({ source: "bust", target: "head" });
  await user.screenshot("graft-swapped-dark");
  await user.press("Control+z");
  await grafted(user);
  expect(await step()).toMatchObject({ source: "head", target: "bust" });
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await user.settle();
  expect(user.complaints).toEqual([]);
}, 180_000);

test("what stays of a part grows, shrinks and is inverted on the part", async () => {
  harness = await EditorHarness.open({
    models: { "bust.ply": ["bust", "--resolution", "40"], "head.ply": ["head", "--resolution", "40"] },
  });
  const { user } = harness;
  const { page } = user;
  await user.click("Graft head");
  await grafted(user);
  await page.getByText("Manual", { exact: true }).click();
  await grafted(user);
  await user.click("Paint fixed area");
  await user.rests();
  const face = await page.evaluate(() => {
    const { viewport, graftView, editor } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(editor.graft.source.value?.mesh ?? -1));
    return [x, y] as const;
  });
  await user.stroke([face, [face[0] + 25, face[1]]]);
  await grafted(user);
  const state = () =>
    page.evaluate(() => {
      const { state } = window.meshgraft.editor;
      const fixed = window.meshgraft.editor.graft.kept.value?.fixed as { indices?: number[] } | undefined;
      return {
        on: state.value?.selected_on,
        selected: state.value?.selected ?? 0,
        fixed: fixed?.indices?.length ?? 0,
      };
    });
  const painted = await state();
  expect(painted.on).toBe("head");
  expect(painted.fixed).toBeGreaterThan(3);
  await user.press("+");
  await user.rests();
  await grafted(user);
  const wider = await state();
  expect(wider.on).toBe("head");
  expect(wider.fixed).toBeGreaterThan(painted.fixed);
  await user.screenshot("graft-fixed-grown");
  await user.press("-");
  await user.rests();
  await grafted(user);
  expect((await state()).fixed).toBeLessThan(wider.fixed);
  const all = await page.evaluate(() => window.meshgraft.editor.graft.source.value?.vertices ?? 0);
  const before = (await state()).fixed;
  await user.press("i");
  await page.waitForFunction(
    (count) => window.meshgraft.editor.state.value?.selected === count,
    all - before,
  );
  expect((await state()).fixed).toBe(all - before);
  for (let i = 0; i < 4; ++i) await user.press("Control+z");
  expect(user.complaints).toEqual([]);
}, 180_000);

test("an earlier graft and an earlier cut are changed from the steps panel, and the later steps follow", async () => {
  harness = await EditorHarness.open({
    models: { "bust.ply": ["bust", "--resolution", "30"], "head.ply": ["head", "--resolution", "30"] },
  });
  const { user } = harness;
  const { page } = user;
  await user.click("Graft head");
  await grafted(user);
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await page.evaluate(async () => {
    const plane = { point: [0.02, 0, 0], normal: [1, 0, 0] } as const;
    await window.meshgraft.editor.ask({
      do: "cut",
      plane: { point: [...plane.point], normal: [...plane.normal] },
      keep: "above",
    });
  });
  await user.settle();
  await page.getByRole("tab", { name: "Deform" }).click();
  if ((await page.getByRole("list", { name: "Steps" }).count()) === 0) await page.getByText("Steps", { exact: true }).click();
  const steps = page.getByRole("list", { name: "Steps" });
  const fields = (index: number) =>
    page.evaluate((i) => window.meshgraft.editor.state.value?.steps[i]?.fields as Record<string, unknown>, index);
  const leftmost = () =>
    page.evaluate(() => {
      const { main } = window.meshgraft.viewport;
      let least = Infinity;
      for (let i = 0; i < (main?.rest.length ?? 0); i += 3) least = Math.min(least, main?.rest[i] ?? 0);
      return least + (main?.offset[0] ?? 0);
    });
  const typed = async (label: string, text: string) => {
    const field = steps.getByRole("textbox", { name: label, exact: true });
    await field.fill(text);
    await field.press("Enter");
    await user.settle();
  };

  await steps.getByText("2. Cut").click();
  await user.screenshot("steps-cut");
  expect(await leftmost()).toBeCloseTo(0.02, 4);
  await typed("Point X", "-0.1");
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  await steps.getByText("Both", { exact: true }).click();
  await user.settle();
  expect((await fields(1))["keep"]).toBe("both");
  expect(await leftmost()).toBeLessThan(-0.11);
  await user.press("Control+z");
  await user.settle();
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  await typed("Point X", "50"); // nothing is above: the step is impossible
  await page.getByRole("alert").or(page.getByRole("status")).getByText(/./).first().waitFor();
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  expect(((await fields(1))["plane"] as { point: number[] }).point[0]).toBe(-0.1);
  await user.screenshot("steps-refused");

  await steps.getByText("1. Graft: head on bust").click();
  await typed("Tilt", "20");
  await typed("Twist by", "90");
  const changed = await fields(0);
  expect(changed["normal_angle_deg"]).toBe(20);
  expect(JSON.stringify(changed["pairs"] ?? changed["matches"])).toMatch(/\d+,\d+/);
  await user.screenshot("steps-graft");
  await steps.getByText("Bend", { exact: true }).click();
  await user.settle();
  expect((await fields(0))["shape"]).toBe("ft05");
}, 180_000);
