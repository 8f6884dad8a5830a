import { mkdirSync, rmSync } from "node:fs";
import { afterAll, beforeAll, expect, test } from "vitest";
import { cutOff } from "./cut_off";
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

const scans = (count: number) =>
  Object.fromEntries(Array.from({ length: count }, (_, i) => [`scan ${i + 1}.ply`, ["bar", "--resolution", "8"]]));

test("own models are large cards above the samples, recent ones first, and one search finds all", async () => {
  const own = await EditorHarness.open({ files: scans(40) });
  const { user } = own;
  const { page } = user;
  const cards = page.getByRole("list", { name: "Your models" }).getByRole("listitem");
  const firstWords = async () => (await cards.first().innerText()).split("\n");
  await expect.poll(() => cards.count()).toBe(10);
  await expect.poll(() => cards.locator("img.thumbnail").count()).toBe(10);
  expect((await firstWords())[0]).toBe("scan 1.ply"); // by name, as people count
  await user.screenshot("start-own-forty");
  const top = (title: string) => page.getByRole("heading", { name: title }).evaluate((one) => one.getBoundingClientRect().top);
  expect(await top("Your models")).toBeLessThan(await top("Samples"));
  await user.click("Show all 40");
  expect(await cards.count()).toBe(40);

  const search = page.getByRole("searchbox", { name: "Search models and samples" });
  await search.fill("SCAN 27");
  expect(await cards.count()).toBe(1);
  expect(await page.getByRole("heading", { name: "Samples" }).count()).toBe(0);
  await search.fill("octopus");
  expect(await cards.count()).toBe(0);
  await page.getByRole("list", { name: "Samples" }).getByText("octopus").first().waitFor();
  await search.fill("no such");
  await page.getByRole("status").getByText("Nothing has this name.").waitFor();
  await user.screenshot("start-search");
  await search.fill("scan 3.");
  await page.getByRole("status").getByText("4 models found. Enter opens the first.").waitFor();
  await user.screenshot("start-found");
  await search.press("Enter");
  await user.opened();
  await page.waitForFunction(() => document.activeElement === window.meshgraft.viewport.canvas);
  await page.evaluate(() => sessionStorage.removeItem(`meshgraft open ${location.pathname}`)); // or else the model is opened again
  await page.reload();
  await user.ready();
  await expect.poll(firstWords).toEqual(["scan 3.ply", expect.stringMatching(/^Recent, in /)]);

  // A file that is written appears, and one that is gone does not, though it is a recent one.
  putSample(["bar", "--resolution", "8"], own.folder.file("other.ply"));
  rmSync(own.folder.file("scan 3.ply"));
  await page.evaluate(() => ++window.meshgraft.editor.filesWritten.value);
  await expect.poll(firstWords).toEqual(["other.ply", expect.anything()]);
  expect(user.complaints).toEqual([]);
  await own.close();
});

test.each([[1280, 800, false], [800, 600, false], [800, 600, true]])(
  "nothing of the start screen is cut off, and its scroll is seen (%i by %i, touch: %s)",
  async (width, height, touch) => {
    for (const dark of [false, true])
      for (const count of [0, 1, 40]) {
        const own = await EditorHarness.open({ files: scans(count), size: { width, height }, touch, dark });
        const { user } = own;
        const { page } = user;
        const cards = page.getByRole("list", { name: "Your models" }).locator("img.thumbnail");
        await expect.poll(() => cards.count()).toBe(Math.min(10, count));
        await page.waitForFunction(() => [...document.querySelectorAll<HTMLImageElement>(".start img")].every((one) => one.complete));
        expect(await cutOff(user, ".start")).toEqual([]);
        expect(await page.locator(".start").evaluate((start) => start.scrollWidth - start.clientWidth)).toBe(0);
        await user.screenshot(`start-${width}${touch ? "-touch" : ""}-${dark ? "dark" : "light"}-${count}`);
        const more = page.locator(".start-more");
        const scrolls = await page.locator(".start").evaluate((start) => start.scrollHeight > start.clientHeight + 8);
        expect(scrolls || height > 600).toBe(true);
        expect(await more.count()).toBe(scrolls ? 1 : 0);
        await page.locator(".start").evaluate((start) => start.scrollTo(0, start.scrollHeight));
        await more.waitFor({ state: "detached" });
        await own.close();
      }
  },
  120_000,
);

test("models of folders within have cards, after those of the folder itself", async () => {
  const own = await EditorHarness.open({ files: { "scan.ply": ["bar", "--resolution", "8"] } });
  const { user } = own;
  const { page } = user;
  const cards = page.getByRole("list", { name: "Your models" }).getByRole("listitem");
  await expect.poll(() => cards.count()).toBe(1);
  mkdirSync(own.folder.file("lamps/old"), { recursive: true });
  putSample(["bar", "--resolution", "8"], own.folder.file("lamps/old/a lamp.ply"));
  await page.evaluate(() => ++window.meshgraft.editor.filesWritten.value);
  await expect.poll(() => cards.allInnerTexts()).toEqual([expect.stringMatching(/^scan.ply/), "a lamp.ply\nold"]);
  await page.getByRole("searchbox", { name: "Search models and samples" }).fill("lamps");
  await expect.poll(() => cards.count()).toBe(1);
  await user.screenshot("start-within");
  await cards.first().getByRole("button").press("Enter");
  await user.opened();
  await page.waitForFunction(() => document.activeElement === window.meshgraft.viewport.canvas);
  expect(user.complaints).toEqual([]);
  await own.close();
});

test("folders are entered, and their models have pictures", async () => {
  const folder = await EditorHarness.open();
  const { user } = folder;
  const { page } = user;
  mkdirSync(folder.folder.file("lamps"));
  putSample(["bar", "--resolution", "8"], folder.folder.file("lamps/lamp.ply"));
  const list = page.getByRole("list", { name: "Files" });
  await list.getByRole("button").first().click();
  await list.getByText("lamps").click();
  await list.locator("img.thumbnail").waitFor();
  await list.getByText("lamp.ply").click();
  await user.opened();
  expect(user.complaints).toEqual([]);
  await folder.close();
});
