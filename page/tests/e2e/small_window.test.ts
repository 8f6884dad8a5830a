import { afterEach, expect, test } from "vitest";
import { EditorHarness, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Returns the labels of the buttons and fields that reach out of the window or of the bar that holds them. */
function cutOff(user: User, bars: string): Promise<string[]> {
  return user.page.evaluate((bars) => {
    const said = (one: Element) => one.getAttribute("aria-label") ?? one.textContent ?? "?";
    return [...document.querySelectorAll(bars)].flatMap((bar) => {
      const outer = bar.getBoundingClientRect();
      return [...bar.querySelectorAll("button, input, .tool-hint")]
        .filter((one) => one.getClientRects().length > 0)
        .filter((one) => {
          const { left, right } = one.getBoundingClientRect();
          return left < outer.left - 1 || right > Math.min(outer.right, innerWidth) + 1;
        })
        .map(said);
    });
  }, bars);
}

const bars = ".header, .tool-line, .side, .status, .toolbar";

test("nothing is cut off in a small window, and the panels fold", async () => {
  harness = await EditorHarness.open({ size: { width: 800, height: 600 }, dark: true });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "select", how: "set", what: { half_space: { point: [0, 0, 3], normal: [0, 0, 1] } } });
  });
  await user.click("Make handle");
  await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await user.settle();
  await user.press("Shift+s"); // snapping has the longest line of options
  await user.screenshot("small-window");
  expect(await cutOff(user, bars)).toEqual([]);
  await user.press("b");
  await user.screenshot("small-window-brush");
  expect(await cutOff(user, bars)).toEqual([]);
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.screenshot("small-window-graft");
  expect(await cutOff(user, bars)).toEqual([]);

  const width = () => page.evaluate(() => document.querySelector(".view")?.clientWidth ?? 0);
  const before = await width();
  await user.press("j");
  await page.getByRole("complementary", { name: "Panels" }).waitFor({ state: "detached" });
  expect(await width()).toBeGreaterThan(before + 200);
  await user.screenshot("small-window-folded");
  await user.click("Panels");
  await page.getByRole("complementary", { name: "Panels" }).waitFor();
  expect(user.complaints).toEqual([]);
}, 120_000);
