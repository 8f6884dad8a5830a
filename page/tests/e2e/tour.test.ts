// Follows the tour of docs/editor.md, and takes the guide's pictures (tools/docs_pictures.sh).
import { afterAll, beforeAll, expect, test } from "vitest";
import { gripOf, poseOf } from "./grips";
import { hashOf, run, Stage } from "./harness";

let stage: Stage;
beforeAll(async () => {
  stage = await Stage.open();
});
afterAll(() => stage.close());

test("grafts a head, bends the neck, looks at it and saves", async () => {
  const { person, folder } = stage;
  const { page } = person;
  const rests = () => person.rests();
  const isExact = async () => {
    await person.settle();
    await page.locator(".status").getByText("Exact", { exact: true }).waitFor();
  };

  await page.waitForFunction(() => document.querySelectorAll(".cards img").length === 12);
  await person.screenshot("editor_start.jpg");
  await person.click(/^bust/);
  await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await page.getByRole("tab", { name: "Graft" }).click();
  await person.click("Add head");
  await page.waitForFunction(() => {
    const { editor } = window.meshgraft;
    return editor.isIdle() && editor.graft.report.value?.seam != null;
  });
  await rests();
  await person.screenshot("editor_graft.jpg");
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await person.settle();
  await page.getByRole("tab", { name: "Deform" }).click();

  await person.press("Numpad1"); // from the front
  await rests();
  const [left, top, width, height] = await page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return [box.left, box.top, box.width, box.height] as const;
  });
  await person.press("t");
  await person.press("m");
  await person.stroke([
    [left + 0.25 * width, top + 0.52 * height],
    [left + 0.75 * width, top + 0.01 * height],
  ]);
  await person.settle();
  await person.screenshot("editor_select.jpg");
  await person.click("Make handle");
  await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  const ring = await gripOf(person, "view-ring");
  await person.stroke([ring, [ring[0] + 60, ring[1] + 50]]);
  await isExact();
  await person.screenshot("editor_bend.jpg");
  expect(Math.abs((await poseOf(person))?.rotate?.angle_deg ?? 0)).toBeGreaterThan(5);

  await page.getByRole("button", { name: "View", exact: true }).click();
  await page.getByLabel("Heat map").selectOption("stretch");
  await page.mouse.move(left + 0.5 * width, top - 20); // hides the tooltip
  await rests();
  await person.screenshot("editor_stretch.jpg");

  await person.press("Control+s");
  await page.getByRole("dialog").getByRole("textbox").fill("portrait");
  await person.press("Enter");
  await page.getByText("Saved", { exact: true }).waitFor();

  const [replayed, shown] = [folder.file("replayed.ply"), folder.file("shown.ply")];
  await page.evaluate(async (mesh) => {
    await window.meshgraft.editor.ask({ do: "save", mesh });
  }, shown);
  run("run", folder.file("portrait.json"), "-o", replayed);
  expect(hashOf(replayed)).toBe(hashOf(shown));
  expect(person.complaints).toEqual([]);
});
