import { afterEach, expect, test } from "vitest";
import { close, grafted, open } from "../e2e/grafting";

afterEach(close);

test("a dropped part that reaches out of the view comes into it", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("torus", 40);
  await page.getByRole("tab", { name: "Graft" }).click();
  await page.evaluate(() => window.meshgraft.editor.graft.addPart({ sample: "head", resolution: 40 }, false));
  await page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 1);
  await user.rests();
  const highest = () =>
    page.evaluate(() => {
      const { viewport, editor } = window.meshgraft;
      const positions = editor.graft.preview.value?.floats("positions") ?? viewport.main?.rest ?? new Float32Array();
      const at = Array.from({ length: positions.length / 3 }, (_, v) => positions[3 * v + 2]!);
      const top = viewport.camera.position.clone().fromArray(positions, 3 * at.indexOf(Math.max(...at)));
      return viewport.project(top).y - viewport.canvas.getBoundingClientRect().top;
    });
  await page.mouse.move(480, 400);
  for (let i = 0; i < 12 && (await highest()) > 40; ++i) await user.wheel(-240).then(() => user.rests());
  await page.evaluate(() => window.meshgraft.editor.graft.set({ source: "head", at: { point: [0, 1, 0.8] } }));
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  await user.rests();
  await user.screenshot("drop-framed");
  expect(await highest()).toBeGreaterThan(0);
  expect(user.complaints).toEqual([]);
}, 120_000);
