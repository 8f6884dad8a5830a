import { existsSync } from "node:fs";
import { expect, test } from "vitest";
import { Stage, type Person } from "./harness";

/** Presses tab until an element of this name has the focus. */
async function tabTo(person: Person, name: RegExp, most = 60): Promise<void> {
  for (let i = 0; i < most; ++i) {
    const label = await person.page.evaluate(() => {
      const element = document.activeElement;
      if (!(element instanceof HTMLElement)) return "";
      const named = element.getAttribute("aria-labelledby");
      return element.getAttribute("aria-label") ?? (named === null ? null : document.getElementById(named)?.textContent) ?? element.textContent ?? "";
    });
    if (name.test(label)) return;
    await person.page.keyboard.press("Tab");
  }
  throw new Error(`tab does not come to ${name}`);
}

async function hasVisibleFocus(person: Person): Promise<boolean> {
  return person.page.evaluate(() => {
    const element = document.activeElement;
    if (element === null) return false;
    const around = element.closest("label, .number") ?? element;
    const style = (one: Element) => getComputedStyle(one);
    return style(element).outlineStyle !== "none" || style(around).outlineStyle !== "none" || around.matches(".number:focus-within");
  });
}

test.each([false, true])("a model is opened, deformed and saved without a pointer (dark: %s)", async (dark) => {
  const stage = await Stage.open({ dark, size: { width: 1024, height: 700 } });
  const { person, folder } = stage;
  const { page } = person;
  const name = dark ? "dark" : "light";
  try {
    await person.screenshot(`panels-start-${name}`);
    await tabTo(person, /^bar/);
    expect(await hasVisibleFocus(person)).toBe(true);
    await person.press("Enter");
    await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
    await person.settle();

    await person.press("h");
    expect(await page.evaluate(() => window.meshgraft.editor.tools.tool.value)).toBe("handle");
    await person.press("b");
    await person.press("a");
    await page.waitForFunction(() => window.meshgraft.editor.selected.value > 0);
    for (let ring = 0; ring < 3; ++ring) await person.press("-"); // the selection of all vertices has no boundary, so nothing shrinks
    await page.evaluate(async () => {
      await window.meshgraft.editor.ask({ do: "select", how: "set", what: { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } } });
    });
    await tabTo(person, /^Make handle/);
    await person.press("Enter");
    await page.getByLabel("Move X").waitFor();
    await tabTo(person, /^Move X$/);
    await page.keyboard.type("0.5");
    await person.press("Enter");
    await person.settle();
    await person.screenshot(`panels-keyboard-${name}`);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose)).toEqual({ translate: [0.5, 0, 0] });

    await person.press("ArrowUp"); // raises the number by a step
    await person.settle();
    const x = await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate?.[0] ?? 0);
    expect(x).toBeGreaterThan(0.5);
    await person.press("Control+z"); // a confirmed number is undone as an edit, not as text
    await person.settle();
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate)).toEqual([0.5, 0, 0]);
    await tabTo(person, /^Move X$/);
    await page.keyboard.type("0.25");
    await person.press("Control+s"); // saving commits the typed text
    await page.getByRole("dialog").getByRole("textbox").waitFor();
    await person.press("Escape");
    await person.settle();
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose.translate)).toEqual([0.25, 0, 0]);

    await tabTo(person, /^Move X$/);
    await page.keyboard.press("Shift+Tab"); // leaves the number field, where typed letters are no commands
    await tabTo(person, /^Natural|^Method/);
    await person.press("F1");
    await page.getByRole("dialog").getByText("In two minutes").waitFor();
    await person.screenshot(`panels-help-${name}`);
    await person.press("Escape");
    await page.getByRole("dialog").waitFor({ state: "detached" });

    await person.press("Control+s");
    await page.getByRole("dialog").getByRole("textbox").waitFor();
    await page.keyboard.type("by keys");
    await person.press("Enter");
    await page.getByText("Saved", { exact: true }).waitFor();
    expect(existsSync(folder.file("by keys.json"))).toBe(true);
    expect(person.complaints).toEqual([]);
  } finally {
    await stage.close();
  }
});

test("the file menu goes by arrows, and gives the focus back", async () => {
  const stage = await Stage.open();
  const { person } = stage;
  const { page } = person;
  try {
    await stage.openSample("bar", 8);
    await tabTo(person, /^File$/);
    await person.press("Enter");
    await page.getByRole("menuitem", { name: /^Open/ }).waitFor();
    await person.press("ArrowDown");
    await person.press("ArrowDown");
    await person.press("ArrowDown");
    expect(await page.evaluate(() => document.activeElement?.textContent)).toContain("Export mesh…");
    await person.press("Escape");
    expect(await page.evaluate(() => document.activeElement?.getAttribute("aria-label"))).toBe("File");
    expect(person.complaints).toEqual([]);
  } finally {
    await stage.close();
  }
});

test("tools go by arrows in their bar, and work that takes long is cancelled", async () => {
  const stage = await Stage.open();
  const { person } = stage;
  const { page } = person;
  try {
    await stage.openSample("bar", 8);
    await tabTo(person, /^Look around$/);
    await person.press("ArrowDown");
    await person.press("Enter");
    expect(await page.evaluate(() => window.meshgraft.editor.tools.tool.value)).toBe("handle");
    await person.press("Tab");
    expect(await page.evaluate(() => document.activeElement?.closest(".toolbar"))).toBeNull();

    await page.evaluate(() => void window.meshgraft.editor.ask({ do: "open", sample: "bumpy_plane", resolution: 3000 }));
    await page.getByRole("progressbar", { name: "Opening" }).waitFor();
    await person.screenshot("panels-progress");
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.getByRole("progressbar", { name: "Opening" }).waitFor({ state: "detached" });
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.name)).toBe("bar");
    expect(await page.getByRole("alert").count()).toBe(0); // a cancelled request needs no message
    expect(person.complaints).toEqual([]);
  } finally {
    await stage.close();
  }
});
