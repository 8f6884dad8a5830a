import { afterAll, beforeAll, expect, test } from "vitest";
import { Stage } from "./harness";

let stage: Stage;
beforeAll(async () => {
  stage = await Stage.open();
});
afterAll(() => stage.close());

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
