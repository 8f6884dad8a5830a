import { afterEach, expect, test } from "vitest";
import { aimAt, exported, farthest, gripOf, openFresh, poseOf, sampled, verticesOf } from "./grips";
import { EditorHarness, hashOf, type HarnessOptions, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Presses Ctrl+Z until nothing is left to undo, and returns how often. */
async function undoAll(user: User): Promise<number> {
  const left = () => user.page.evaluate(() => window.meshgraft.editor.state.value?.undo ?? null);
  for (let count = 0; count < 100; ++count) {
    if ((await left()) === null) return count;
    const steps = await user.page.evaluate(() => window.meshgraft.editor.state.value);
    await user.press("Control+z");
    await user.page.waitForFunction(
      (before) =>
        window.meshgraft.editor.isIdle() && JSON.stringify(window.meshgraft.editor.state.value) !== before,
      JSON.stringify(steps),
    );
  }
  throw new Error("undo does not come to an end");
}

/** Returns the largest difference of a shown coordinate from rest. */
function strayed(user: User): Promise<number> {
  return user.page.evaluate(() => {
    const surface = window.meshgraft.viewport.main;
    return (
      surface?.positions.reduce((most, x, i) => Math.max(most, Math.abs(x - (surface.rest[i] ?? NaN))), 0) ??
      NaN
    );
  });
}

async function openWith(files: HarnessOptions["files"] & {}, first: RegExp) {
  harness = await EditorHarness.open({ files });
  await harness.user.page.getByRole("button", { name: first }).first().click();
  await harness.user.opened();
  return { harness, user: harness.user };
}

test("a selection, handles, moves and an accepted step are all taken back, to the byte", async () => {
  const { harness, user } = await openWith({ "octopus.ply": ["octopus", "--resolution", "60"] }, /octopus\.ply/);
  const opened = hashOf(harness.folder.file("octopus.ply"));
  expect(hashOf(await exported(harness, "untouched"))).toBe(opened);
  const rest = sampled(harness, "octopus", 60);

  const top = await aimAt(user, farthest(rest, [0, -0.2, 1]));
  await user.press("b");
  await user.stroke([top, [top[0] + 20, top[1] + 10]]);
  await user.settle();
  await user.press("+");
  await user.press("Shift+h");
  await user.settle();
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, [ball[0] + 20, ball[1] - 60]]);
  await user.settle();
  await user.press("Control+Enter");
  await user.settle();

  const tip = await aimAt(user, farthest(rest, [1, -0.3, 0]));
  await user.press("h");
  await user.stroke([tip, [tip[0] - 6, tip[1] + 4]]);
  await user.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await user.settle();
  const name = await user.page.evaluate(() => window.meshgraft.editor.tools.activeHandle.value ?? "");
  expect((await verticesOf(user, name)).length).toBeGreaterThan(0);
  for (const key of ["r", "z", "4", "5", "Enter"]) await user.press(key);
  await user.settle();
  await user.page.getByText("Smooth rotation", { exact: true }).click();
  await user.settle();
  await user.screenshot("undo-before");
  expect(hashOf(await exported(harness, "bent"))).not.toBe(opened);

  expect(await undoAll(user)).toBeGreaterThanOrEqual(6);
  await user.settle();
  await user.screenshot("undo-after");
  expect(await strayed(user)).toBe(0);
  expect(hashOf(await exported(harness, "undone"))).toBe(opened);
  expect(hashOf(harness.folder.file("octopus.ply"))).toBe(opened);
  await user.page.waitForFunction(() => !document.title.startsWith("●"));
  expect(user.complaints).toEqual([]);
}, 240_000);

/** Presses keys in quick succession, before the page draws. */
function pressAtOnce(user: User, keys: readonly { key: string; ctrlKey?: boolean }[]): Promise<void> {
  return user.page.evaluate((all) => {
    for (const one of all) window.dispatchEvent(new KeyboardEvent("keydown", { ...one, bubbles: true }));
  }, keys);
}
const ctrlZ = { key: "z", ctrlKey: true };

/** Waits until the shown surface is at this distance from rest. */
async function strays(user: User, far: number): Promise<void> {
  await user.settle();
  await expect.poll(() => strayed(user), { timeout: 5000 }).toBeCloseTo(far, 5);
  // No frame of an earlier pose comes after the exact frame of the document's pose.
  const pose = await user.page.evaluate(async () => {
    const outcome = await window.meshgraft.editor.ask({ do: "pose", poses: {} });
    return outcome !== undefined && "pose" in outcome ? outcome.pose : undefined;
  });
  await user.page.waitForFunction((last) => {
    const { pose, accuracy } = window.meshgraft.editor.live.value;
    return pose === last && accuracy === "exact";
  }, pose);
  await user.rests();
  expect(await strayed(user)).toBeCloseTo(far, 5);
}

for (const method of ["corotational", "ft05"])
  test(`a gesture that is given up leaves what the document has, whatever else is taken back: ${method}`, async () => {
    harness = await EditorHarness.open();
    const { user } = harness;
    const { page } = user;
    await openFresh(harness, "bust");
    const nose = await aimAt(user, farthest(sampled(harness, "bust"), [0, -1, 0.2]));
    await user.press("h");
    await user.stroke([nose, [nose[0] + 8, nose[1]]]);
    await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
    await user.settle();
    await page.evaluate((method) => window.meshgraft.editor.ask({ do: "settings", settings: { method } }), method);
    await user.settle();
    const ball = await gripOf(user, "ball");
    await user.stroke([ball, [ball[0] + 10, ball[1] - 40]]);
    await page.waitForFunction(() => window.meshgraft.editor.live.value.accuracy === "exact");
    await user.rests();
    const moved = await strayed(user);
    expect(moved).toBeGreaterThan(0.01);
    const drag = async () => {
      const before = await strayed(user);
      const [x, y] = await gripOf(user, "ball");
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 40, y - 80, { steps: 6 });
      await expect.poll(async () => Math.abs((await strayed(user)) - before)).toBeGreaterThan(1e-3);
    };
    const letGo = async () => {
      await page.mouse.move(500, 200, { steps: 3 });
      await page.mouse.up();
    };

    await drag();
    await user.press("Control+z");
    await letGo();
    await strays(user, moved);

    await drag();
    await pressAtOnce(user, [ctrlZ, ctrlZ]);
    await letGo();
    await strays(user, 0);
    expect(await poseOf(user)).toEqual({});

    // A gesture by keys goes on while the panel changes the pose.
    await user.press("Control+Shift+z");
    await strays(user, moved);
    await pressAtOnce(user, [{ key: "g" }]);
    await page.mouse.move(520, 300, { steps: 4 });
    await page.getByRole("button", { name: "Reset", exact: true }).click();
    await user.settle();
    await user.press("Escape");
    await strays(user, 0);
    expect(user.complaints).toEqual([]);
  });

test("a cut and a graft are taken back, to the byte", async () => {
  const { harness, user } = await openWith(
    { "bust.ply": ["bust", "--resolution", "40"], "head.ply": ["head", "--resolution", "40"] },
    /bust\.ply/,
  );
  const { page } = user;
  const opened = hashOf(harness.folder.file("bust.ply"));
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Cut by a plane");
  await user.click("Across Z");
  await page.waitForFunction(() => window.meshgraft.editor.graft.cutPlane.value !== null);
  await user.click("Keep blue side");
  await page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  await user.press("Control+z");
  await user.settle();
  await user.press("Control+Shift+z");
  await user.settle();
  expect(hashOf(await exported(harness, "cut"))).not.toBe(opened);
  await user.press("Control+z");
  await user.settle();

  await page.getByLabel("Where parts come from").selectOption({ index: 1 });
  await user.click("Add head");
  await page.waitForFunction(
    () => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value?.seam !== undefined,
    undefined,
    { timeout: 60_000 },
  );
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  expect(hashOf(await exported(harness, "grafted"))).not.toBe(opened);
  await user.screenshot("undo-graft-before");

  expect(await undoAll(user)).toBeGreaterThanOrEqual(3);
  await user.settle();
  await user.screenshot("undo-graft-after");
  expect(await strayed(user)).toBe(0);
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.parts)).toEqual([]);
  expect(hashOf(await exported(harness, "undone"))).toBe(opened);
  expect(user.complaints).toEqual([]);
}, 240_000);
