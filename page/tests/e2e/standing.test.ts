import { afterEach, expect, test } from "vitest";
import { readFileSync, writeFileSync } from "node:fs";
import { EditorHarness, run } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

test("any side is made the front or the upper side at the view cube, and that is remembered", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  const open = async (sample: string) => {
    await page.evaluate((sample) => window.meshgraft.editor.open({ do: "open", sample, resolution: 20 }), sample);
    await user.opened();
  };
  await open("bust");
  const upright = () => page.evaluate(() => ({ ...window.meshgraft.viewport.navigation.upright }));
  const choose = async (item: string) => {
    await user.click("How the model stands");
    await user.screenshot("standing-menu");
    await page.getByRole("menuitem", { name: item }).click();
    await user.rests();
  };
  /** Returns whether the model lies within the view. */
  const isWhole = async () => {
    const { width, height } = (await page.locator("canvas").boundingBox())!;
    const count = await page.evaluate(() => window.meshgraft.viewport.main?.vertexCount ?? 0);
    const places = await Promise.all(Array.from({ length: count }, (_, v) => user.screenOf(v)));
    return places.every(([x, y]) => x >= 0 && y >= 0 && x <= width && y <= height);
  };
  const start = await upright();
  expect(start).toEqual({ up: "z", front: "-y" });
  await user.press("3"); // from the right
  await user.rests();
  await choose("This side is the front");
  expect(await upright()).toEqual({ up: "z", front: "x" });
  expect(await page.getByRole("radio", { name: "Front" }).isChecked()).toBe(true);
  await user.screenshot("standing-front");

  await choose("This side is up"); // it lies on its back
  expect(await upright()).toEqual({ up: "x", front: "-z" });
  await user.screenshot("standing-up");
  await page.reload();
  await user.opened();
  expect(await upright()).toEqual({ up: "x", front: "-z" });
  await open("torus");
  expect(await upright()).toEqual(start);
  await open("bust");
  expect(await upright()).toEqual({ up: "x", front: "-z" });
  expect(await isWhole()).toBe(true); // it is taller now than as it lay before
  await choose("As in the file");
  expect(await upright()).toEqual(start);
  expect(user.complaints).toEqual([]);
});

test("a model that faces sideways in its file is shown from its front, until the user chooses another", async () => {
  harness = await EditorHarness.open();
  const { user, folder } = harness;
  const upright = () => user.page.evaluate(() => ({ ...window.meshgraft.viewport.navigation.upright }));
  /** Opens a sample that is turned by a right angle about the vertical. */
  const openTurned = async (sample: string) => {
    const file = folder.file(`${sample}.obj`);
    run("sample", sample, "--resolution", "40", "-o", file);
    const turned = readFileSync(file, "utf8").replace(/^v (\S+) (\S+) (\S+)/gm, (_, x, y, z) => `v ${-Number(y)} ${x} ${z}`);
    writeFileSync(file, turned);
    await harness?.openFile(file);
  };
  await openTurned("bust");
  await user.screenshot("standing-turned-bust");
  const { up, front } = await upright();
  expect(up).toBe("z");
  expect(["x", "-x"]).toContain(front); // the shoulders lie along y
  await openTurned("dinosaur");
  expect(await upright()).toEqual({ up: "z", front: "-y" }); // the head lies at -x without the turn
  await user.screenshot("standing-turned-dinosaur");
  await harness.openSample("dinosaur", 40);
  expect(await upright()).toEqual({ up: "z", front: "-x" });
  await openTurned("cylinder");
  expect(await upright()).toEqual({ up: "z", front: "-y" });
  await user.page.evaluate((path) => window.meshgraft.editor.open({ do: "open", path }), folder.file("bust.obj"));
  await user.opened();
  await user.press("3"); // from the right
  await user.rests();
  await user.click("How the model stands");
  await user.page.getByRole("menuitem", { name: "This side is the front" }).click();
  await user.rests();
  const chosen = (await upright()).front;
  expect(["y", "-y"]).toContain(chosen);
  await user.page.reload();
  await user.opened();
  expect((await upright()).front).toBe(chosen);
  expect(user.complaints).toEqual([]);
});
