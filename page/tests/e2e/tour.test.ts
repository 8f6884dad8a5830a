// Follows the tour of docs/editor.md, and takes the guide's pictures (tools/docs_pictures.sh).
import { afterAll, beforeAll, expect, test } from "vitest";
import { gripOf, poseOf } from "./grips";
import { EditorHarness, hashOf, run } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

test("grafts a head, bends the neck, looks at it and saves", async () => {
  const { user, folder } = harness;
  const { page } = user;
  const rests = () => user.rests();
  const isExact = async () => {
    await user.settle();
    await page.locator(".status").getByText("Exact", { exact: true }).waitFor();
  };

  await page.waitForFunction(() => document.querySelectorAll(".cards img").length === 12);
  await user.screenshot("editor_start.jpg");
  await user.click(/^bust/);
  await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Add head");
  await page.waitForFunction(() => {
    const { editor } = window.meshgraft;
    return editor.isIdle() && editor.graft.report.value?.seam != null;
  });
  await page.mouse.move(400, 560); // hides the tooltip
  await rests();
  await user.screenshot("editor_graft.jpg");
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  await page.getByRole("tab", { name: "Deform" }).click();

  await user.press("Numpad1"); // from the front
  await rests();
  const [left, top, width, height] = await page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return [box.left, box.top, box.width, box.height] as const;
  });
  await user.press("t");
  await user.press("m");
  await user.stroke([
    [left + 0.25 * width, top + 0.52 * height],
    [left + 0.75 * width, top + 0.01 * height],
  ]);
  await user.settle();
  await user.screenshot("editor_select.jpg");
  await user.click("Make handle");
  await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  const ring = await gripOf(user, "view-ring");
  await user.stroke([ring, [ring[0] + 60, ring[1] + 50]]);
  await isExact();
  await user.screenshot("editor_bend.jpg");
  expect(Math.abs((await poseOf(user))?.rotate?.angle_deg ?? 0)).toBeGreaterThan(5);

  await page.getByRole("button", { name: "View", exact: true }).click();
  await page.getByLabel("Heat map").selectOption("stretch");
  await page.mouse.move(left + 0.5 * width, top - 20); // hides the tooltip
  await rests();
  await user.screenshot("editor_stretch.jpg");

  await user.press("Control+s");
  await page.getByRole("dialog").getByRole("textbox").fill("portrait");
  await user.press("Enter");
  await page.getByText("Saved", { exact: true }).waitFor();

  const [replayed, shown] = [folder.file("replayed.ply"), folder.file("shown.ply")];
  await page.evaluate(async (mesh) => {
    await window.meshgraft.editor.ask({ do: "save", mesh });
  }, shown);
  run("run", folder.file("portrait.json"), "-o", replayed);
  expect(hashOf(replayed)).toBe(hashOf(shown));
  expect(user.complaints).toEqual([]);
});
