import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness } from "./harness";
import { openFresh, poseOf } from "./grips";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

/** Opens the bar with a handle at its top that was moved three times, along X to 0.3. */
async function openMoved(): Promise<void> {
  const { user } = harness;
  await openFresh(harness, "bar", 8);
  await user.page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } }, reach: 1 });
    editor.tools.activeHandle.value = "top";
    for (const x of [0.1, 0.2, 0.3]) await editor.pose({ top: { translate: [x, 0, 0] } });
  });
  await user.rests();
}

async function expectMoved(x: number): Promise<void> {
  await harness.user.settle();
  const [moved = NaN] = (await poseOf(harness.user, "top"))?.translate ?? [0];
  expect(moved).toBeCloseTo(x, 6);
}

test("Enter and Space after a click on Undo undo nothing more", async () => {
  const { user } = harness;
  await openMoved();
  await user.click("Undo");
  await expectMoved(0.2);
  for (const key of ["Enter", "Space"]) {
    await user.press(key);
    await expectMoved(0.2);
  }
  expect(user.complaints).toEqual([]);
});

test("Enter after a click on Undo ends a move by keys", async () => {
  const { user } = harness;
  await openMoved();
  await user.click("Undo");
  await expectMoved(0.2);
  for (const key of ["g", "x", ".", "5", "Enter"]) await user.press(key);
  await expectMoved(0.7);

  // A button that is clicked during the move leaves it going on.
  for (const key of ["g", "x", ".", "1"]) await user.press(key);
  await user.click("Local axes");
  await user.press("Enter");
  await expectMoved(0.8);
  expect(user.complaints).toEqual([]);
});

test("Enter presses a button that Tab moves the focus to, but ends a move that begins there", async () => {
  const { user } = harness;
  const { page } = user;
  await openMoved();
  const isOn = (label: string) => page.evaluate((name) => document.activeElement?.getAttribute("aria-label") === name, label);
  for (let presses = 0; presses < 60 && !(await isOn("Undo")); ++presses) await user.press("Tab");
  expect(await isOn("Undo")).toBe(true);
  await user.press("Enter");
  await expectMoved(0.2);
  await user.press("Space");
  await expectMoved(0.1);
  for (const key of ["g", "x", "1", "Enter"]) await user.press(key);
  await expectMoved(1.1);
  expect(user.complaints).toEqual([]);
});
