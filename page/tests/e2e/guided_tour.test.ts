// Follows the guided tour of the first start.
import { afterEach, expect, test } from "vitest";
import { gripOf, poseOf } from "./grips";
import { EditorHarness, theme, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

const bubble = ({ page }: User, title: string) => page.getByRole("dialog", { name: title });

test("the buttons of six bubbles lead through an edit of a sample", async () => {
  harness = await EditorHarness.open({ firstStart: true });
  const { user } = harness;
  const { page } = user;
  const titles = ["Open a model", "Graft another one onto it", "Change it, and accept it", "Take hold of something", "Move it", "Keep it"];
  const actions = ["Open bust", "Graft the head", "Accept the graft", "Hold the head", "Turn the head", "Finish"];
  for (const [k, title] of titles.entries()) {
    await bubble(user, title).waitFor({ timeout: 60_000 });
    await bubble(user, title).getByText(`${k + 1} of 6`).waitFor();
    if (await page.evaluate(() => window.meshgraft.editor.state.value !== null)) await user.rests();
    await user.screenshot(`tour-${k + 1}-${theme}`);
    await bubble(user, title).getByRole("button", { name: actions[k] as string }).click();
  }
  await bubble(user, "Keep it").waitFor({ state: "detached" });
  await user.settle();
  const state = await page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state?.steps.map(({ kind }) => kind)).toEqual(["merge", "deform"]);
  expect((await poseOf(user, "head"))?.rotate?.angle_deg).toBe(15);
  expect(await page.getByRole("alert").count()).toBe(0);
  expect(user.complaints).toEqual([]);
}, 240_000);

test("a bubble goes on when the user does what it says, and escape ends the tour for good", async () => {
  harness = await EditorHarness.open({ firstStart: true });
  const { user } = harness;
  const { page } = user;
  await bubble(user, "Open a model").waitFor();
  await user.click(/^bust/);
  await bubble(user, "Graft another one onto it").waitFor();
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Add head");
  await bubble(user, "Change it, and accept it").waitFor({ timeout: 60_000 });
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await bubble(user, "Take hold of something").waitFor();
  await page.getByRole("tab", { name: "Deform" }).click();
  await user.press("h");
  await user.rests();
  const middle = await page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return [box.left + box.width / 2, box.top + box.height / 2] as const;
  });
  await user.stroke([middle, [middle[0] + 10, middle[1] + 10]]);
  await bubble(user, "Move it").waitFor();
  await user.settle();
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, [ball[0] + 20, ball[1] - 20]]);
  await bubble(user, "Keep it").waitFor();
  await user.press("Escape");
  await bubble(user, "Keep it").waitFor({ state: "detached" });
  const next = await harness.tab();
  await next.page.getByRole("heading", { name: "Samples" }).waitFor();
  expect(await bubble(next, "Open a model").count()).toBe(0);

  await user.press("?");
  await page.getByRole("dialog", { name: "Help" }).getByText("While moving, rotating, scaling").waitFor();
  await user.screenshot("tour-help");
  await page.getByRole("dialog", { name: "Help" }).getByRole("button", { name: "Start the guided tour" }).click();
  await bubble(user, "Open a model").waitFor(); // the open bust has steps already
  expect(user.complaints).toEqual([]);
});

test("a bubble stays until its step is done or the user goes on, and a reload resumes it", async () => {
  harness = await EditorHarness.open({ firstStart: true });
  const { user } = harness;
  const { page } = user;
  await bubble(user, "Open a model").waitFor();
  expect(await bubble(user, "Open a model").getByRole("button", { name: "Next" }).count()).toBe(0); // nothing is open
  await bubble(user, "Open a model").getByRole("button", { name: "Open bust" }).click();
  const graft = bubble(user, "Graft another one onto it");
  await graft.waitFor();
  await user.rests();
  // A step that is refused is not done.
  await page.evaluate(() => {
    const { editor } = window.meshgraft;
    editor.graft.addPart = () => editor.ask({ do: "part", what: "add", sample: "none" }).then(() => undefined);
  });
  await graft.getByRole("button", { name: "Graft the head" }).click();
  await page.getByRole("alert").first().waitFor();
  await user.rests();
  expect(await graft.isVisible()).toBe(true);

  await graft.getByRole("button", { name: "Next" }).click();
  const accept = bubble(user, "Change it, and accept it");
  expect(await accept.getByRole("button", { name: "Accept the graft" }).isDisabled()).toBe(true);
  await accept.getByRole("button", { name: "Next" }).click();
  const hold = bubble(user, "Take hold of something");
  await hold.getByRole("button", { name: "Hold the head" }).click();
  const move = bubble(user, "Move it");
  await move.waitFor();
  await user.settle();

  await page.reload();
  await user.ready();
  await move.waitFor();
  await user.opened();
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles.length)).toBe(1);
  await user.screenshot("tour-resumed");
  await user.press("Escape");
  await move.waitFor({ state: "detached" });
  await page.reload();
  await user.ready();
  await user.opened();
  expect(await page.getByRole("dialog").count()).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("the tour speaks of fingers on a screen that fingers touch, and brings what it points at into view", async () => {
  harness = await EditorHarness.open({ firstStart: true, touch: true, size: { width: 560, height: 400 } });
  const { user } = harness;
  await bubble(user, "Open a model").getByText("Tap bust").waitFor();
  await user.page.waitForFunction(() => {
    const box = document.querySelector('[data-sample="bust"]')?.getBoundingClientRect();
    return box !== undefined && box.top >= 0 && box.bottom <= innerHeight - 44;
  });
  await user.screenshot(`tour-touch-small-${theme}`);
  await user.page.setViewportSize({ width: 800, height: 600 });
  await user.screenshot(`tour-touch-${theme}`);
  await bubble(user, "Open a model").getByRole("button", { name: "Open bust" }).tap();
  await bubble(user, "Graft another one onto it").waitFor();
  await user.rests();
  await user.screenshot(`tour-touch-graft-${theme}`);
  expect(user.complaints).toEqual([]);
});
