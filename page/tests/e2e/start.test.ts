import { afterAll, beforeAll, expect, test } from "vitest";
import { Stage } from "./harness";

let stage: Stage;
beforeAll(async () => {
  stage = await Stage.open();
});
afterAll(() => stage.close());

/** Returns whether the focus is in the view cube. */
const isOnCube = () => stage.person.page.evaluate(() => document.activeElement?.closest(".view-cube") !== null);

test("tab visits no view cube while nothing is shown", async () => {
  const { page } = stage.person;
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press("Tab");
    expect(await isOnCube()).toBe(false);
  }
  expect(await page.locator(".view-cube").isVisible()).toBe(false);
});

test("opens a sample from a fresh page", async () => {
  const { person } = stage;
  await person.click(/octopus/i);
  await person.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await person.settle();
  const state = await person.page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state?.model.vertices).toBeGreaterThan(1000);
  await person.screenshot("start-octopus");
  expect(person.complaints).toEqual([]);
});

test("tells which models have unsaved work, and restores it", async () => {
  const { person } = stage;
  const { page } = person;
  expect(await page.locator(".view-cube").isVisible()).toBe(true);
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "region" }).then(() => undefined));
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "paint-handle", vertices: [0], name: "tip" }).then(() => undefined));
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.dirty === true);
  page.once("dialog", (dialog) => void dialog.accept());
  await page.reload();
  await page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
  await page.getByRole("button", { name: /octopus.*has unsaved work to restore/ }).waitFor();
  await person.screenshot("start-unsaved");
  expect(await page.getByText("has unsaved work to restore").count()).toBe(1);
  await person.click(/octopus/i);
  await person.click("Restore");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles[0]?.name === "tip");
});
