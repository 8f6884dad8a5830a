// Adds folders in the page, and saves parts to the folder of the part library.
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { afterEach, expect, test } from "vitest";
import { EditorHarness, Engine, Folder, freePort, putSample } from "./harness";

let harness: EditorHarness | undefined;
let other: Folder | undefined;
afterEach(async () => {
  await harness?.close();
  other?.remove();
  harness = other = undefined;
});

test("a folder is added by its path, and is there again with the next engine", async () => {
  other = new Folder();
  putSample(["bar", "--resolution", "8"], other.file("lamp.ply"));
  const port = await freePort();
  harness = await EditorHarness.open({ words: ["--port", port] });
  const { user, folder } = harness;
  const { page } = user;
  const type = async (path: string) => {
    await page.getByRole("textbox", { name: "Path of the folder" }).fill(path);
    await user.press("Enter");
  };
  await user.click("Add a folder…");
  await type(join(other.path, "none"));
  await page.getByRole("alert").getByText(/^There is no such folder/).waitFor();
  await type("models");
  await page.getByRole("alert").getByText(/^This is not the full path/).waitFor();
  await user.screenshot("folders-refused");
  await type(other.path);
  const list = page.getByRole("list", { name: "Files" });
  await list.getByText("lamp.ply").click();
  await user.opened();
  expect(user.complaints).toEqual([]);

  await harness.engine.stop();
  harness.engine = await Engine.start(["--folder", folder.path, "--port", port]);
  await page.goto(harness.engine.url);
  await user.ready();
  await expect.poll(() => page.evaluate(() => window.meshgraft.editor.welcome.value?.folders)).toContain(other.path);
  await user.click(`Forget ${other.path}`);
  await page.getByRole("list", { name: "Files" }).getByText(other.path).waitFor({ state: "detached" });
  await page.reload();
  await user.ready();
  expect(await page.evaluate(() => Object.keys(localStorage).filter((key) => key.startsWith("meshgraft folder ")))).toEqual([]);
});

test("folders that two tabs add are both kept, and seen in both", async () => {
  other = new Folder();
  for (const name of ["first", "second"]) mkdirSync(other.file(name));
  harness = await EditorHarness.open();
  const tabs = [harness.user, await harness.tab()];
  const paths = ["first", "second"].map((name) => other!.file(name));
  await Promise.all(
    tabs.map(({ page }, i) => page.evaluate((path) => window.meshgraft.editor.folders.add(path).then(() => undefined), paths[i] as string)),
  );
  for (const { page } of tabs) {
    await expect.poll(() => page.evaluate(() => window.meshgraft.editor.welcome.value?.folders)).toEqual(expect.arrayContaining(paths));
    const kept = await page.evaluate(() => Object.keys(localStorage).filter((key) => key.startsWith("meshgraft folder ")));
    expect(kept.sort()).toEqual(paths.map((path) => `meshgraft folder ${path}`));
  }
});

test("a half is saved as a part, and grafted from the library's folder", async () => {
  harness = await EditorHarness.open();
  const { user, folder } = harness;
  const { page } = user;
  await harness.openSample("bar", 12);
  await page.evaluate(() =>
    window.meshgraft.editor.ask({ do: "cut", halves: true, plane: { point: [0, 0, 0.5], normal: [0, 0, 1] } }),
  );
  await user.settle();
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("More for bar 2");
  await page.getByRole("menuitem", { name: "Save as a part" }).click();
  await page.getByText("Saved as a part", { exact: true }).waitFor();
  expect(existsSync(folder.file("bar_2.ply"))).toBe(true);
  await page.getByRole("button", { name: "Add bar_2" }).waitFor();
  await user.screenshot("folders-saved-part");

  await user.click(/^File menu/);
  await page.getByRole("menuitem", { name: "Save as a part" }).click();
  await page.getByRole("button", { name: "Add bar", exact: true }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.parts.length === 2);
  expect(user.complaints).toEqual([]);
});
