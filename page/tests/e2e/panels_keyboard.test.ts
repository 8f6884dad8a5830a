import { existsSync } from "node:fs";
import { expect, test } from "vitest";
import { EditorHarness, theme, type User } from "./harness";
import { tabTo } from "./tab_to";

async function hasVisibleFocus(user: User): Promise<boolean> {
  return user.page.evaluate(() => {
    const element = document.activeElement;
    if (element === null) return false;
    const around = element.closest("label, .number") ?? element;
    const style = (one: Element) => getComputedStyle(one);
    return style(element).outlineStyle !== "none" || style(around).outlineStyle !== "none" || around.matches(".number:focus-within");
  });
}

test("a model is opened, deformed and saved without a pointer", async () => {
  const harness = await EditorHarness.open({ size: { width: 1024, height: 700 } });
  const { user, folder } = harness;
  const { page } = user;
  try {
    await user.screenshot(`panels-start-${theme}`);
    await tabTo(user, /^bar/);
    expect(await hasVisibleFocus(user)).toBe(true);
    await user.press("Enter");
    await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
    await user.settle();

    await user.press("h");
    expect(await page.evaluate(() => window.meshgraft.editor.tools.tool.value)).toBe("handle");
    await user.press("b");
    await user.press("a");
    await page.waitForFunction(() => window.meshgraft.editor.selected.value > 0);
    for (let ring = 0; ring < 3; ++ring) await user.press("-"); // the selection of all vertices has no boundary, so nothing shrinks
    await page.evaluate(async () => {
      await window.meshgraft.editor.ask({ do: "select", how: "set", what: { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } } });
    });
    await tabTo(user, /^Make handle/);
    await user.press("Enter");
    await page.getByLabel("Move X").waitFor();
    await tabTo(user, /^Move X$/);
    await page.keyboard.type("0.5");
    await user.press("Enter");
    await user.settle();
    await user.screenshot(`panels-keyboard-${theme}`);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose)).toEqual({ translate: [0.5, 0, 0] });

    await user.press("ArrowUp"); // raises the number by a step
    await user.settle();
    const x = await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate?.[0] ?? 0);
    expect(x).toBeGreaterThan(0.5);
    await user.press("Control+z"); // a confirmed number is undone as an edit, not as text
    await user.settle();
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate)).toEqual([0.5, 0, 0]);
    await tabTo(user, /^Move X$/);
    await page.keyboard.type("0.25");
    await user.press("Control+s"); // saving commits the typed text
    await page.getByRole("dialog").getByRole("textbox").waitFor();
    await user.press("Escape");
    await user.settle();
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate)).toEqual([0.25, 0, 0]);

    await tabTo(user, /^Move X$/);
    await page.keyboard.press("Shift+Tab"); // leaves the number field, where typed letters are no commands
    await tabTo(user, /^Natural|^Method/);
    await user.press("F1");
    await page.getByRole("dialog").getByText("Two-minute tour").waitFor();
    await user.screenshot(`panels-help-${theme}`);
    await user.press("Escape");
    await page.getByRole("dialog").waitFor({ state: "detached" });

    await user.press("Control+s");
    await page.getByRole("dialog").getByRole("textbox").waitFor();
    await page.keyboard.type("by keys");
    await user.press("Enter");
    await page.getByText("Saved", { exact: true }).waitFor();
    expect(existsSync(folder.file("by keys.json"))).toBe(true);
    expect(user.complaints).toEqual([]);
  } finally {
    await harness.close();
  }
});

test("the file menu goes by arrows, and gives the focus back", async () => {
  const harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  try {
    await harness.openSample("bar", 8);
    await tabTo(user, /^File menu/);
    await user.press("Enter");
    await page.getByRole("menuitem", { name: /^Open/ }).waitFor();
    await user.press("ArrowDown");
    await user.press("ArrowDown");
    await user.press("ArrowDown");
    expect(await page.evaluate(() => document.activeElement?.textContent)).toContain("Export mesh…");
    await user.press("Escape");
    expect(await page.evaluate(() => document.activeElement?.textContent)).toMatch(/^File menu/);
    expect(user.complaints).toEqual([]);
  } finally {
    await harness.close();
  }
});

test("tools go by arrows in their bar, and work that takes long is cancelled", async () => {
  const harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  try {
    await harness.openSample("bar", 8);
    await tabTo(user, /^Navigate$/);
    await user.press("ArrowDown");
    await user.press("Enter");
    expect(await page.evaluate(() => window.meshgraft.editor.tools.tool.value)).toBe("handle");
    await user.press("Tab");
    expect(await page.evaluate(() => document.activeElement?.closest(".toolbar"))).toBeNull();

    await page.evaluate(() => void window.meshgraft.editor.ask({ do: "open", sample: "bumpy_plane", resolution: 3000 }));
    await page.getByRole("progressbar", { name: "Opening" }).waitFor();
    await user.screenshot("panels-progress");
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.getByRole("progressbar", { name: "Opening" }).waitFor({ state: "detached" });
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.name)).toBe("bar");
    expect(await page.getByRole("alert").count()).toBe(0); // a cancelled request needs no message
    expect(user.complaints).toEqual([]);
  } finally {
    await harness.close();
  }
});
