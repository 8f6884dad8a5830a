import { afterEach, expect, test } from "vitest";
import { EditorHarness } from "./harness";

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
  await choose("As in the file");
  expect(await upright()).toEqual(start);
  expect(user.complaints).toEqual([]);
}, 120_000);
