import { afterEach, expect, test } from "vitest";
import { close, open } from "./grafting";
import type { Point } from "./harness";

afterEach(close);

test("a line that begins and ends off the model sets the plane, and the sides are blue and red", async () => {
  const { harness, user } = await open();
  await harness.openSample("octopus", 40);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  const cameraPosition = () => user.page.evaluate(() => window.meshgraft.viewport.camera.position.toArray());
  const start = await cameraPosition();
  await user.stroke([[200, 680], [260, 640]]); // off the model, without a cutting tool
  await user.rests();
  expect(await cameraPosition()).not.toEqual(start);
  await user.click("Cut by a plane");
  await user.rests();
  const before = await cameraPosition();
  const middle = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y] as const;
  });
  await user.stroke([[110, middle[1] - 10], [800, middle[1] - 10]], { steps: 12 });
  await user.rests();
  expect(await cameraPosition()).toEqual(before);
  const picture = (await user.page.screenshot()).toString("base64");
  const sides = await user.page.evaluate(async (png) => {
    const image = new Image();
    image.src = `data:image/png;base64,${png}`;
    await image.decode();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [image.width, image.height];
    const context = copy.getContext("2d");
    context?.drawImage(image, 0, 0);
    const seen = { red: 0, blue: 0 };
    const scale = image.width / window.innerWidth;
    for (let y = 0; y < window.innerHeight; y += 6)
      for (let x = 0; x < window.innerWidth; x += 6) {
        if (window.meshgraft.viewport.pick(x, y) === undefined) continue;
        const [r = 0, , b = 0] = context?.getImageData(Math.floor(x * scale), Math.floor(y * scale), 1, 1).data ?? [];
        if (Math.abs(r - b) > 25) seen[r > b ? "red" : "blue"] += 1;
      }
    return seen;
  }, picture);
  await user.screenshot("cut-line-beside");
  expect(sides.red).toBeGreaterThan(50);
  expect(sides.blue).toBeGreaterThan(50);
  await user.click("Keep blue side");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  expect(await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.loops)).toBeGreaterThan(0);
  expect(user.complaints).toEqual([]);
});

test("cuts by a plane and along a curve, and keeps the other side instead", async () => {
  const { harness, user } = await open();
  await harness.openSample("octopus", 40);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Cut by a plane");
  const middle = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y] as const;
  });
  await user.stroke([[middle[0] - 60, middle[1]], [middle[0] + 60, middle[1]]]);
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.cutPlane.value !== null);
  await user.screenshot("cut-plane");
  const faces = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.faces ?? 0);
  await user.click("Keep blue side");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  const cut = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model);
  expect(cut?.faces).toBeLessThan(faces);
  expect(cut?.loops).toBeGreaterThan(0);
  await user.screenshot("cut-plane-done");
  await user.page.evaluate(() => window.meshgraft.editor.graft.cutOtherwise());
  await user.settle();
  const other = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.faces ?? 0);
  expect(other).not.toBe(cut?.faces);
  await user.press("Control+z");
  await user.settle();
  await user.click("Cut along a curve");
  await user.rests();
  const c = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y - 60] as const;
  });
  const round = Array.from({ length: 25 }, (_, i): Point => [c[0] + 32 * Math.cos((i * Math.PI) / 12), c[1] + 28 * Math.sin((i * Math.PI) / 12)]);
  await user.stroke(round, { steps: 3 });
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.cutCurve.value?.closed === true);
  await user.screenshot("cut-curve");
  await user.press("Enter");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  const piece = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model);
  expect(piece?.loops).toBe(1);
  expect(piece?.faces).toBeLessThan(faces / 2);
  await user.screenshot("cut-curve-done");
  expect(user.complaints).toEqual([]);
}, 240_000);

test("a cut is closed by pins and holes, and the other half can be kept instead", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("bust", 40);
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Cut by a plane");
  await page.getByRole("button", { name: "Across Z" }).click();
  const model = () => page.evaluate(() => window.meshgraft.editor.state.value?.model);
  await page.locator(".cut-in-work").getByText("Flat", { exact: true }).click();
  await page.locator(".cut-in-work").getByText("Pins", { exact: true }).click();
  await user.screenshot("cut-pins-plane");
  await user.click("Keep red side");
  await page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  const step = () => page.evaluate(() => window.meshgraft.editor.state.value?.steps[0]?.fields as { pins?: object; keep?: string });
  expect(await step()).toMatchObject({ pins: {}, keep: "below" });
  const pinned = await model();
  await user.screenshot("cut-pins-done");
  await page.evaluate(() => window.meshgraft.editor.graft.cutOtherwise());
  await user.settle();
  expect((await step()).keep).toBe("above");
  expect((await model())?.faces).not.toBe(pinned?.faces);
  await user.screenshot("cut-pins-other");
  expect(user.complaints).toEqual([]);
}, 240_000);
