import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, putSample } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

/** Returns whether the focus is in the view cube. */
const isOnCube = () => harness.user.page.evaluate(() => document.activeElement?.closest(".view-cube") !== null);

test("tab visits no view cube while nothing is shown", async () => {
  const { page } = harness.user;
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press("Tab");
    expect(await isOnCube()).toBe(false);
  }
  expect(await page.locator(".view-cube").isVisible()).toBe(false);
});

test("each sample has a picture", async () => {
  const { page } = harness.user;
  await page.getByRole("button", { name: /^octopus/ }).waitFor();
  const widths = () => page.locator(".start-samples img").evaluateAll((all) => all.map((one) => (one as HTMLImageElement).naturalWidth));
  await expect.poll(widths).toEqual(Array.from({ length: await page.locator(".start-samples li").count() }, () => 144));
});

test("opens a sample from a fresh page", async () => {
  const { user } = harness;
  await user.click(/octopus/i);
  await user.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await user.settle();
  const state = await user.page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state?.model.vertices).toBeGreaterThan(1000);
  await user.screenshot("start-octopus");
  expect(user.complaints).toEqual([]);
});

test("tells which models have unsaved work, and restores it", async () => {
  const { user } = harness;
  const { page } = user;
  expect(await page.locator(".view-cube").isVisible()).toBe(true);
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "region" }).then(() => undefined));
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "paint-handle", vertices: [0], name: "tip" }).then(() => undefined));
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.dirty === true);
  page.once("dialog", (dialog) => void dialog.accept());
  await page.reload();
  await page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
  await page.getByRole("button", { name: /octopus.*has unsaved work to restore/ }).waitFor();
  await user.screenshot("start-unsaved");
  expect(await page.getByText("has unsaved work to restore").count()).toBe(1);
  await user.click(/octopus/i);
  await user.click("Restore");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles[0]?.name === "tip");
});

test("models of a folder have pictures, and are found by their names", async () => {
  const files = Object.fromEntries(Array.from({ length: 10 }, (_, i) => [`scan ${i}.ply`, ["bar", "--resolution", "8"]]));
  const folder = await EditorHarness.open({ files });
  const { user } = folder;
  const { page } = user;
  const list = page.getByRole("list", { name: "Files" });
  await list.locator("img.thumbnail").first().waitFor();
  const search = page.getByRole("searchbox", { name: "Search this folder" });
  await search.fill("SCAN 7");
  expect(await list.getByRole("listitem").count()).toBe(1);
  await user.screenshot("start-search");
  await search.fill("no such");
  await list.getByText("No matching files here.").waitFor();
  await search.fill("");
  expect(await list.getByRole("listitem").count()).toBe(10);

  // A file that is written appears in the list that is open.
  putSample(["bar", "--resolution", "8"], folder.folder.file("other.ply"));
  await page.evaluate(() => ++window.meshgraft.editor.filesWritten.value);
  await list.getByText("other.ply").waitFor();
  await list.getByText("scan 3.ply").click();
  await user.opened();
  expect(user.complaints).toEqual([]);
  await folder.close();
}, 60_000);
