import { afterEach, expect, test } from "vitest";
import { aimAt, exported, farthest, gripOf, openFresh, poseOf, sampled, verticesOf } from "./grips";
import { hashOf, positionsOf, run, Stage, type Person } from "./harness";

let stage: Stage | undefined;
afterEach(async () => {
  await stage?.close();
  stage = undefined;
});

/** Presses Ctrl+Z until nothing is left to undo, and returns how often. */
async function undoAll(person: Person): Promise<number> {
  const left = () => person.page.evaluate(() => window.meshgraft.editor.state.value?.undo ?? null);
  for (let count = 0; count < 100; ++count) {
    if ((await left()) === null) return count;
    const steps = await person.page.evaluate(() => window.meshgraft.editor.state.value);
    await person.press("Control+z");
    await person.page.waitForFunction(
      (before) =>
        window.meshgraft.editor.isIdle() && JSON.stringify(window.meshgraft.editor.state.value) !== before,
      JSON.stringify(steps),
    );
  }
  throw new Error("undo does not come to an end");
}

/** Returns the largest difference of a shown coordinate from rest. */
function strayed(person: Person): Promise<number> {
  return person.page.evaluate(() => {
    const surface = window.meshgraft.viewport.main;
    return (
      surface?.positions.reduce((most, x, i) => Math.max(most, Math.abs(x - (surface.rest[i] ?? NaN))), 0) ??
      NaN
    );
  });
}

async function openWith(files: Readonly<Record<string, readonly [string, string]>>, first: RegExp) {
  stage = await Stage.open();
  for (const [file, [sample, resolution]] of Object.entries(files))
    run("sample", sample, "--resolution", resolution, "-o", stage.folder.file(file));
  await stage.person.page.reload();
  await stage.person.page.getByRole("button", { name: first }).first().click();
  await stage.person.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await stage.person.settle();
  return { stage, person: stage.person };
}

test("a selection, handles, moves and an accepted step are all taken back, to the byte", async () => {
  const { stage, person } = await openWith({ "octopus.ply": ["octopus", "60"] }, /octopus\.ply/);
  const opened = hashOf(stage.folder.file("octopus.ply"));
  expect(hashOf(await exported(stage, "untouched"))).toBe(opened);
  run("sample", "octopus", "--resolution", "60", "-o", stage.folder.file("octopus.obj"));
  const rest = positionsOf(stage.folder.file("octopus.obj"));

  const top = await aimAt(person, farthest(rest, [0, -0.2, 1]));
  await person.press("b");
  await person.stroke([top, [top[0] + 20, top[1] + 10]]);
  await person.settle();
  await person.press("+");
  await person.press("Shift+h");
  await person.settle();
  const ball = await gripOf(person, "ball");
  await person.stroke([ball, [ball[0] + 20, ball[1] - 60]]);
  await person.settle();
  await person.press("Control+Enter");
  await person.settle();

  const tip = await aimAt(person, farthest(rest, [1, -0.3, 0]));
  await person.press("h");
  await person.stroke([tip, [tip[0] - 6, tip[1] + 4]]);
  await person.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await person.settle();
  const name = await person.page.evaluate(() => window.meshgraft.editor.tools.activeHandle.value ?? "");
  expect((await verticesOf(person, name)).length).toBeGreaterThan(0);
  for (const key of ["r", "z", "4", "5", "Enter"]) await person.press(key);
  await person.settle();
  await person.page.getByText("Smooth turns", { exact: true }).click();
  await person.settle();
  await person.screenshot("undo-before");
  expect(hashOf(await exported(stage, "bent"))).not.toBe(opened);

  expect(await undoAll(person)).toBeGreaterThanOrEqual(6);
  await person.settle();
  await person.screenshot("undo-after");
  expect(await strayed(person)).toBe(0);
  expect(hashOf(await exported(stage, "undone"))).toBe(opened);
  expect(hashOf(stage.folder.file("octopus.ply"))).toBe(opened);
  await person.page.waitForFunction(() => !document.title.startsWith("●"));
  expect(person.complaints).toEqual([]);
}, 240_000);

/** Presses keys in quick succession, before the page draws. */
function pressAtOnce(person: Person, keys: readonly { key: string; ctrlKey?: boolean }[]): Promise<void> {
  return person.page.evaluate((all) => {
    for (const one of all) window.dispatchEvent(new KeyboardEvent("keydown", { ...one, bubbles: true }));
  }, keys);
}
const ctrlZ = { key: "z", ctrlKey: true };

/** Waits until the shown surface is at this distance from rest. */
async function strays(person: Person, far: number): Promise<void> {
  await person.settle();
  await expect.poll(() => strayed(person), { timeout: 5000 }).toBeCloseTo(far, 5);
  await person.page.waitForTimeout(300); // a late frame must not change it again
  expect(await strayed(person)).toBeCloseTo(far, 5);
}

for (const method of ["corotational", "ft05"])
  test(`a gesture that is given up leaves what the document has, whatever else is taken back: ${method}`, async () => {
    stage = await Stage.open();
    const { person } = stage;
    const { page } = person;
    await openFresh(stage, "bust");
    const nose = await aimAt(person, farthest(sampled(stage, "bust"), [0, -1, 0.2]));
    await person.press("h");
    await person.stroke([nose, [nose[0] + 8, nose[1]]]);
    await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
    await person.settle();
    await page.evaluate((method) => window.meshgraft.editor.ask({ do: "settings", settings: { method } }), method);
    await person.settle();
    const ball = await gripOf(person, "ball");
    await person.stroke([ball, [ball[0] + 10, ball[1] - 40]]);
    await page.waitForFunction(() => window.meshgraft.editor.live.value.quality === "exact");
    await person.rests();
    const moved = await strayed(person);
    expect(moved).toBeGreaterThan(0.01);
    const drag = async () => {
      const before = await strayed(person);
      const [x, y] = await gripOf(person, "ball");
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 40, y - 80, { steps: 6 });
      await expect.poll(async () => Math.abs((await strayed(person)) - before)).toBeGreaterThan(1e-3);
    };
    const letGo = async () => {
      await page.mouse.move(500, 200, { steps: 3 });
      await page.mouse.up();
    };

    await drag();
    await person.press("Control+z");
    await letGo();
    await strays(person, moved);

    await drag();
    await pressAtOnce(person, [ctrlZ, ctrlZ]);
    await letGo();
    await strays(person, 0);
    expect(await poseOf(person)).toEqual({});

    // A gesture by keys goes on while the panel changes the pose.
    await person.press("Control+Shift+z");
    await strays(person, moved);
    await pressAtOnce(person, [{ key: "g" }]);
    await page.mouse.move(520, 300, { steps: 4 });
    await page.getByRole("button", { name: "Put back" }).click();
    await person.settle();
    await person.press("Escape");
    await strays(person, 0);
    expect(person.complaints).toEqual([]);
  }, 120_000);

test("a cut and a graft are taken back, to the byte", async () => {
  const { stage, person } = await openWith(
    { "bust.ply": ["bust", "40"], "head.ply": ["head", "40"] },
    /bust\.ply/,
  );
  const { page } = person;
  const opened = hashOf(stage.folder.file("bust.ply"));
  await page.getByRole("tab", { name: "Graft" }).click();
  await person.click("Cut by a plane");
  await person.click("Across Z");
  await page.waitForFunction(() => window.meshgraft.editor.graft.cutPlane.value !== null);
  await person.click("Keep blue side");
  await page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await person.settle();
  await person.press("Control+z");
  await person.settle();
  await person.press("Control+Shift+z");
  await person.settle();
  expect(hashOf(await exported(stage, "cut"))).not.toBe(opened);
  await person.press("Control+z");
  await person.settle();

  await page.getByLabel("Where parts come from").selectOption({ index: 1 });
  await person.click("Add head");
  await page.waitForFunction(
    () => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value?.seam !== undefined,
    undefined,
    { timeout: 60_000 },
  );
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await person.settle();
  expect(hashOf(await exported(stage, "grafted"))).not.toBe(opened);
  await person.screenshot("undo-graft-before");

  expect(await undoAll(person)).toBeGreaterThanOrEqual(3);
  await person.settle();
  await person.screenshot("undo-graft-after");
  expect(await strayed(person)).toBe(0);
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.parts)).toEqual([]);
  expect(hashOf(await exported(stage, "undone"))).toBe(opened);
  expect(person.complaints).toEqual([]);
}, 240_000);
