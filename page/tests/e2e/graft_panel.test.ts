import { mkdirSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { run, Stage, type Person } from "./harness";

let stage: Stage | undefined;
afterEach(async () => {
  await stage?.close();
  stage = undefined;
});

/** Presses tab until an element of this name has the focus. */
async function tabTo(person: Person, name: RegExp): Promise<void> {
  for (let i = 0; i < 80; ++i) {
    const label = await person.page.evaluate(
      () => document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? "",
    );
    if (name.test(label)) return;
    await person.page.keyboard.press("Tab");
  }
  throw new Error(`tab does not come to ${name}`);
}

async function grafted(person: Person): Promise<void> {
  await person.page.waitForFunction(
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
  stage = await Stage.open({ dark: true, models: { "bust.ply": ["bust", "--resolution", "40"] } });
  const { person, folder } = stage;
  const { page } = person;
  page.setDefaultTimeout(20_000);
  mkdirSync(folder.file("parts"));
  for (const name of ["head", "cylinder", "knot"])
    run("sample", name, "--resolution", "40", "-o", folder.file(`parts/${name}.ply`));
  await page.reload(); // the new page sees the new folder
  await person.opened();
  await tabTo(person, /^Deform$/);
  await person.press("ArrowRight");
  await page.waitForFunction(() => window.meshgraft.editor.graft.mode.value === "graft");

  await tabTo(person, /^Where parts come from$/);
  await person.press("ArrowDown");
  await tabTo(person, /parts$/);
  await person.press("Enter");
  await page.getByRole("button", { name: "Add knot" }).waitFor();
  await page.waitForFunction(
    () => document.querySelectorAll('[aria-label="parts"] img.thumbnail').length === 3,
  );
  await person.screenshot("graft-folder-dark");
  await tabTo(person, /^Add head$/);
  await person.press("Enter");
  await grafted(person);
  await person.screenshot("graft-dark");
  const step = () => page.evaluate(() => window.meshgraft.editor.graft.kept.value);
  expect(await step()).toMatchObject({ source: "head", target: "bust" });

  await page.getByText("More of the graft").click();
  await person.click("Swap the two");
  await page.waitForFunction(() => window.meshgraft.editor.graft.kept.value?.source === "bust");
  await grafted(person);
  expect(await step()).toMatchObject({ source: "bust", target: "head" });
  await person.screenshot("graft-swapped-dark");
  await person.press("Control+z");
  await grafted(person);
  expect(await step()).toMatchObject({ source: "head", target: "bust" });
  await person.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await person.settle();
  expect(person.complaints).toEqual([]);
}, 180_000);

test("what stays of a part grows, shrinks and is inverted on the part", async () => {
  stage = await Stage.open({
    models: { "bust.ply": ["bust", "--resolution", "40"], "head.ply": ["head", "--resolution", "40"] },
  });
  const { person } = stage;
  const { page } = person;
  page.setDefaultTimeout(20_000);
  await person.click("Graft head");
  await grafted(person);
  await page.getByText("Keep", { exact: true }).click();
  await grafted(person);
  await person.click("Paint what stays");
  await person.rests();
  const face = await page.evaluate(() => {
    const { viewport, graftView, editor } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(editor.graft.source.value?.mesh ?? -1));
    return [x, y] as const;
  });
  await person.stroke([face, [face[0] + 25, face[1]]]);
  await grafted(person);
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
  await person.press("+");
  await person.rests();
  await grafted(person);
  const wider = await state();
  expect(wider.on).toBe("head");
  expect(wider.fixed).toBeGreaterThan(painted.fixed);
  await person.screenshot("graft-fixed-grown");
  await person.press("-");
  await person.rests();
  await grafted(person);
  expect((await state()).fixed).toBeLessThan(wider.fixed);
  const all = await page.evaluate(() => window.meshgraft.editor.graft.source.value?.vertices ?? 0);
  const before = (await state()).fixed;
  await person.press("i");
  await page.waitForFunction(
    (count) => window.meshgraft.editor.state.value?.selected === count,
    all - before,
  );
  expect((await state()).fixed).toBe(all - before);
  for (let i = 0; i < 4; ++i) await person.press("Control+z");
  expect(person.complaints).toEqual([]);
}, 180_000);

test("an earlier graft and an earlier cut are changed from the steps panel, and the later steps follow", async () => {
  stage = await Stage.open({
    models: { "bust.ply": ["bust", "--resolution", "30"], "head.ply": ["head", "--resolution", "30"] },
  });
  const { person } = stage;
  const { page } = person;
  page.setDefaultTimeout(20_000);
  await person.click("Graft head");
  await grafted(person);
  await person.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await page.evaluate(async () => {
    const plane = { point: [0.02, 0, 0], normal: [1, 0, 0] } as const;
    await window.meshgraft.editor.ask({
      do: "cut",
      plane: { point: [...plane.point], normal: [...plane.normal] },
      keep: "above",
    });
  });
  await person.settle();
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
    await person.settle();
  };

  await steps.getByText("2. Cut").click();
  await person.screenshot("steps-cut");
  expect(await leftmost()).toBeCloseTo(0.02, 4);
  await typed("Point X", "-0.1");
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  await steps.getByText("Both", { exact: true }).click();
  await person.settle();
  expect((await fields(1))["keep"]).toBe("both");
  expect(await leftmost()).toBeLessThan(-0.11);
  await person.press("Control+z");
  await person.settle();
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  await typed("Point X", "50"); // nothing is above: the step is impossible
  await page.getByRole("alert").or(page.getByRole("status")).getByText(/./).first().waitFor();
  expect(await leftmost()).toBeCloseTo(-0.1, 4);
  expect(((await fields(1))["plane"] as { point: number[] }).point[0]).toBe(-0.1);
  await person.screenshot("steps-refused");

  await steps.getByText("1. Graft").click();
  await typed("Normal angle", "20");
  await typed("Twist by", "90");
  const changed = await fields(0);
  expect(changed["normal_angle_deg"]).toBe(20);
  expect(JSON.stringify(changed["pairs"] ?? changed["matches"])).toMatch(/\d+,\d+/);
  await person.screenshot("steps-graft");
  await steps.getByText("Bends", { exact: true }).click();
  await person.settle();
  expect((await fields(0))["shape"]).toBe("ft05");
}, 180_000);
