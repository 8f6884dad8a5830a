import { afterEach, expect, test } from "vitest";
import { EditorHarness } from "../e2e/harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

test("a long set-up is cancelled, and what was before is there at once", async () => {
  harness = await EditorHarness.open({ models: { "bar.ply": ["bar", "--resolution", "480"] } });
  const { user } = harness;
  const { page } = user;
  page.setDefaultTimeout(20_000);
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.model.vertices ?? 0)).toBeGreaterThan(
    200_000,
  );
  // The region is the whole model, whose set-up is the slowest.
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const above = (z: number) => ({ half_space: { point: [0, 0, z], normal: [0, 0, 1] } });
    await editor.ask({ do: "region", select: "all" });
    await editor.ask({ do: "fixed", select: { half_space: { point: [0, 0, 0.2], normal: [0, 0, -1] } } });
    await editor.ask({ do: "settings", settings: { method: "ft05" } });
    await editor.ask({ do: "handle", what: "add", name: "top", select: above(3.8) });
    await editor.pose({ top: { translate: [0.5, 0, 0] } });
  });
  await user.settle();
  const state = () =>
    page.evaluate(() =>
      JSON.stringify({ ...window.meshgraft.editor.state.value, redo: null, set_up_for: null }),
    );
  const shown = () => page.evaluate(() => window.meshgraft.viewport.main?.positions[0]);
  const [before, height] = [await state(), await shown()];
  await page.getByText("Natural", { exact: true }).click();
  const cancel = page.locator(".status").getByRole("button", { name: "Cancel" });
  await cancel.waitFor();
  await page.waitForFunction(
    () => (window.meshgraft.editor.state.value?.settings as { method?: string }).method === "corotational",
  );
  await user.screenshot("poses-set-up");
  const began = performance.now();
  await cancel.click();
  await page.waitForFunction(
    () => (window.meshgraft.editor.state.value?.settings as { method?: string }).method === "ft05",
  );
  await user.settle();
  expect(performance.now() - began).toBeLessThan(5000);
  expect(await state()).toBe(before);
  expect(await shown()).toBeCloseTo(height ?? NaN, 9);
  expect(await page.evaluate(() => window.meshgraft.editor.live.value.stage)).toBe("ready");
  await user.screenshot("poses-set-up-cancelled");
  const redo = await page.evaluate(() => window.meshgraft.editor.state.value?.redo);
  expect(redo).toBe("settings"); // the change can be redone
  expect(user.complaints).toEqual([]);
}, 300_000);
