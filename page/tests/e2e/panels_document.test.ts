import { readFileSync } from "node:fs";
import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";
import { settingsTable, usualOf, type NumberSetting, type Settings } from "../../src/app/method_settings";
import { EditorHarness } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
  harness.user.page.setDefaultTimeout(15_000);
});
afterAll(() => harness.close());
beforeEach(async () => {
  await harness.openSample("bar", 8);
  await harness.user.page.evaluate(async () => {
    const { editor } = window.meshgraft;
    if (editor.offer.value !== null) await editor.ask({ do: "discard" }); // removes what the previous test left
    editor.offer.value = null;
    editor.messages.value = [];
    editor.tools.activeHandle.value = null;
  });
});

function state() {
  return harness.user.page.evaluate(() => window.meshgraft.editor.state.value);
}
async function select(z: number): Promise<void> {
  await harness.user.page.evaluate(async (z) => {
    await window.meshgraft.editor.ask({ do: "select", how: "set", what: { half_space: { point: [0, 0, z], normal: [0, 0, 1] } } });
  }, z);
}
async function makeHandle(above = 3): Promise<void> {
  await select(above);
  await harness.user.click("Make handle");
  await harness.user.page.getByLabel("Move X").waitFor();
  await harness.user.settle();
}
async function section(title: string): Promise<void> {
  const button = harness.user.page.locator(".side").getByRole("button", { name: new RegExp(`^${title}`) }).first();
  if ((await button.getAttribute("aria-expanded")) === "false") await button.click();
}
async function type(label: string, text: string): Promise<void> {
  const field = harness.user.page.getByRole("textbox", { name: label, exact: true }).first();
  await field.fill(text);
  await field.press("Enter");
  await harness.user.settle();
}

test("a handle is posed by numbers with units, renamed, put back and removed", async () => {
  const { user } = harness;
  await makeHandle();
  await user.click("View");
  await user.page.getByLabel("Unit", { exact: true }).selectOption("mm"); // a sample has no unit of its own
  await user.click("View");
  const size = user.page.locator(".status > span").last();
  const atRest = await size.innerText();
  await type("Move X", "5 cm");
  await user.page.waitForFunction((before) => [...document.querySelectorAll(".status > span")].at(-1)?.textContent !== before, atRest);
  expect(await size.innerText()).toMatch(/^5\d.* mm$/); // 50 mm and the width of the bar
  await type("Rotation angle", "2 turns");
  await type("Scale", "150 %");
  expect((await state())?.handles[0]?.pose).toEqual({
    translate: [50, 0, 0], rotate: { axis: [0, 0, 1], angle_deg: 720 }, scale: [1.5, 1.5, 1.5],
  });
  await type("Move Y", "nonsense");
  expect((await state())?.handles[0]?.pose.translate).toEqual([50, 0, 0]);
  await user.screenshot("panels-pose");
  for (const [text, says] of [["0", "Enter a number above 0."], ["-2", "Enter a number above 0."], ["nothing", "Enter a factor, such as 1.5 or 150 %."]] as const) {
    await type("Scale", text);
    const field = user.page.getByRole("textbox", { name: "Scale", exact: true });
    expect(await field.getAttribute("aria-invalid")).toBe("true");
    expect(await field.evaluate((one) => one === document.activeElement)).toBe(true);
    await user.page.getByRole("alert").getByText(says, { exact: true }).waitFor();
  }
  await user.screenshot("panels-out-of-range");
  await user.press("Tab"); // leaves the field and keeps the old number
  expect(await user.page.getByRole("textbox", { name: "Scale", exact: true }).inputValue()).toBe("1.5");
  expect((await state())?.handles[0]?.pose.scale).toEqual([1.5, 1.5, 1.5]);

  await user.click(/^More for handle/);
  await user.page.getByRole("menuitem", { name: "Rename" }).click();
  await user.page.getByLabel(/^New name of/).fill("end");
  await user.press("Enter");
  await user.page.getByRole("button", { name: /^end/ }).waitFor();
  await user.click("Reset");
  await user.settle();
  expect((await state())?.handles[0]?.pose).toEqual({});
  await user.click("More for end");
  await user.page.getByRole("menuitem", { name: "Remove" }).click();
  await user.page.getByText("Paint the area that you want to move.").first().waitFor();
  expect((await state())?.handles).toEqual([]);
});

test("changes are undone and done again, and named", async () => {
  const { user } = harness;
  await makeHandle();
  await type("Move X", "1");
  const { page } = user;
  const undo = page.getByRole("button", { name: "Undo" });
  expect(await undo.getAttribute("data-tip")).toBe("Undo: move");
  await user.click("Undo");
  await user.settle();
  expect((await state())?.handles[0]?.pose).toEqual({});
  expect(await page.getByRole("button", { name: "Redo" }).getAttribute("data-tip")).toBe("Redo: move");
  await user.press("Control+Shift+z");
  await user.settle();
  expect((await state())?.handles[0]?.pose).toEqual({ translate: [1, 0, 0] });
  await user.press("Control+z");
  await user.press("Control+z");
  await user.settle();
  expect((await state())?.handles).toEqual([]);
  expect(await undo.getAttribute("aria-disabled")).toBe("true");
});

test("methods switch, and show what applies to them", async () => {
  const { user } = harness;
  await makeHandle();
  await type("Reach", "2.5");
  await type("Rotation angle", "90");
  const frames = async (label: string) => {
    await user.page.getByText(label, { exact: true }).click();
    await user.page.waitForFunction((label) => {
      const names: Record<string, string> = {
        Linear: "ft05",
        Natural: "corotational",
        "Smooth rotation": "rotation-aware",
        "Even bends": "shell",
      };
      return (window.meshgraft.editor.state.value?.settings as { method?: string }).method === names[label];
    }, label);
    await user.settle();
    return harness.savedPositions();
  };
  const linear = await frames("Linear");
  expect(await user.page.getByLabel("Stiffness").count()).toBe(0);
  const natural = await frames("Natural");
  expect(await user.page.getByLabel("Stiffness").count()).toBeGreaterThan(0);
  await frames("Smooth rotation");
  expect(await user.page.getByLabel("Smoothing").count()).toBe(0);
  const even = await frames("Even bends");
  expect(await user.page.getByLabel("Smoothing").count()).toBeGreaterThan(0);
  await user.screenshot("panels-even-bends");
  for (const other of [linear, even])
    expect(Math.max(...other.map((x, i) => Math.abs(x - (natural[i] ?? 0))))).toBeGreaterThan(0.01);
});

test("the preset is switched on and off, and the panel shows its settings", async () => {
  const { user } = harness;
  const { page } = user;
  await makeHandle();
  await page.getByText("More settings", { exact: true }).click();
  const preset = page.getByRole("switch", { name: "As published" });
  const shown = () => page.evaluate(() => window.meshgraft.editor.state.value?.settings);
  const density = page.getByLabel("Density");
  expect(await preset.isChecked()).toBe(false);
  expect(await density.inputValue()).toBe("aware");
  await preset.click();
  await user.settle();
  expect(await shown()).toMatchObject({ preset: "as-published", method: "ft05" });
  expect(await preset.isChecked()).toBe(true);
  expect(await density.inputValue()).toBe("ft05");
  expect(await page.getByLabel("Stiffness").count()).toBe(0);
  await user.screenshot("panels-preset");
  // The edit is solved by the settings that the panel shows.
  await page.evaluate(async (path) => {
    await window.meshgraft.editor.ask({ do: "save", edit: path });
  }, harness.folder.file("preset.json"));
  const written = (JSON.parse(readFileSync(harness.folder.file("preset.json"), "utf8")) as {
    steps: { settings: Settings }[];
  }).steps[0]?.settings ?? {};
  expect(written["preset"]).toBe("as-published");
  for (const setting of settingsTable) {
    const usual =
      setting.kind === "switch" ? setting.defaultValue : usualOf({ preset: "as-published" }, setting as NumberSetting);
    expect(String(written[setting.key]), setting.key).toBe(String(usual));
  }
  await user.press("Control+z");
  await user.settle();
  expect(await preset.isChecked()).toBe(false);
  await user.press("Control+Shift+z");
  await user.settle();
  expect(await preset.isChecked()).toBe(true);
  await page.getByRole("button", { name: "Restore defaults" }).click();
  await user.settle();
  expect(await preset.isChecked()).toBe(false);
  expect(await shown()).toMatchObject({ method: "ft05", laplacian_weight: 20 });
  expect(await density.inputValue()).toBe("aware");
});

test("groups are saved, selected, coloured, used and removed", async () => {
  const { user } = harness;
  const { page } = user;
  await section("Groups");
  await select(1.5);
  const selected = await page.evaluate(() => window.meshgraft.editor.selected.value);
  await page.getByLabel("Name of the new group").fill("lid");
  await user.press("Enter");
  await page.getByRole("button", { name: "lid", exact: true }).waitFor();
  await user.press("Alt+a");
  await page.waitForFunction(() => window.meshgraft.editor.selected.value === 0);
  await page.getByRole("button", { name: "lid", exact: true }).click();
  await page.waitForFunction((count) => window.meshgraft.editor.selected.value === count, selected);
  await page.getByLabel("Colour of lid").fill("#123456");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.groups[0]?.colour === "#123456");
  await user.screenshot("panels-groups");
  await user.click("More for lid");
  await page.getByRole("menuitem", { name: "Make fixed" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.undo === "fixed");
  await user.click("More for lid");
  await page.getByRole("menuitem", { name: "Remove" }).click();
  await page.getByRole("alert").getByText(/in use/).waitFor();
  await user.click("Close the message");
  await user.press("Control+z");
  await user.click("More for lid");
  await page.getByRole("menuitem", { name: "Remove" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.groups.length === 0);
});

test("steps are accepted, changed later, renamed and removed", async () => {
  const { user } = harness;
  const { page } = user;
  await makeHandle();
  await type("Move X", "1");
  const one = await harness.savedPositions();
  await user.click("Accept");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.steps.length === 2);
  await section("Steps");
  await page.getByRole("button", { name: /^1\. Deform/ }).click();
  await type("Move X", "2");
  const two = await harness.savedPositions();
  const most = (positions: Float64Array) => positions.reduce((a, x, i) => (i % 3 === 0 ? Math.max(a, x) : a), -Infinity);
  expect(most(two) - most(one)).toBeCloseTo(1, 4);
  await user.screenshot("panels-steps");
  await user.click("More for 1. Deform");
  await page.getByRole("menuitem", { name: "Rename" }).click();
  await page.getByLabel(/^New name of/).fill("lean");
  await user.press("Enter");
  await user.click("More for lean");
  await page.getByRole("menuitem", { name: "Remove" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.steps.length === 1);
});

test("symmetric editing has its plane", async () => {
  const { user } = harness;
  const { page } = user;
  await section("Symmetry");
  await page.getByRole("switch", { name: "Symmetric editing" }).check();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry !== null);
  await page.locator(".section").filter({ hasText: "Symmetric editing" }).getByText("Z", { exact: true }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry?.plane.normal[2] === 1);
  await makeHandle();
  await page.getByText(/^Mirrored: handle 1/).waitFor();
  await type("Move X", "1");
  await user.screenshot("panels-symmetry");
  const positions = await harness.savedPositions();
  let low = -Infinity;
  for (let i = 0; i < positions.length; i += 3) if ((positions[i + 2] ?? 0) < 0.9) low = Math.max(low, positions[i] ?? 0);
  expect(low).toBeGreaterThan(1);
  await page.getByRole("switch", { name: "Symmetric editing" }).uncheck();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry === null);
  expect(user.complaints).toEqual([]);
});

test("the heat map's legend is the open model's, and no message covers it", async () => {
  const { user } = harness;
  const { page } = user;
  await page.evaluate(() => (window.meshgraft.editor.view.heatMap.value = "detail"));
  const legend = page.locator(".view-legend");
  await legend.getByText(/^Detail/).waitFor();
  const before = await page.evaluate(() => window.meshgraft.viewport.legend.value?.max);
  await page.evaluate(() => window.meshgraft.editor.note("Something happened.", "", "This stays."));
  await page.getByText("Something happened.").waitFor();
  await user.screenshot("panels-legend");
  const [told, shown] = [await page.locator(".toast").boundingBox(), await legend.boundingBox()];
  expect((told?.y ?? 0) + (told?.height ?? 0)).toBeLessThanOrEqual(shown?.y ?? 0);
  // The legend changes in the same turn as the model.
  await page.evaluate(() => {
    const { viewport } = window.meshgraft;
    const setMesh = viewport.show.bind(viewport);
    const seen: unknown[] = [];
    viewport.show = (frame) => {
      setMesh(frame);
      seen.push(viewport.legend.value === (viewport.main?.heat.legend ?? null));
    };
    Object.assign(window, { seen });
  });
  await harness.openSample("torus", 20);
  await legend.getByText(/^Detail/).waitFor();
  const fits = await page.evaluate(() => (window as unknown as { seen: boolean[] }).seen);
  expect(fits.length).toBeGreaterThan(0);
  expect(fits).not.toContain(false);
  expect(await page.evaluate(() => window.meshgraft.viewport.legend.value?.max)).not.toBe(before);
  await page.evaluate(() => (window.meshgraft.editor.view.heatMap.value = "none"));
});

test("undo and redo of the making of handles leave one active", async () => {
  const { user } = harness;
  const active = () => user.page.evaluate(() => window.meshgraft.editor.tools.activeHandle.value);
  const step = async (keys: string, handles: number) => {
    await user.press(keys);
    await user.page.waitForFunction(
      (count) => window.meshgraft.editor.isIdle() && window.meshgraft.editor.state.value?.handles.length === count,
      handles,
    );
  };
  await makeHandle(3);
  const [first] = [await active()];
  await user.page.evaluate(() =>
    window.meshgraft.editor.ask({ do: "paint-handle", vertices: [0], name: "other" }).then(() => (window.meshgraft.editor.tools.activeHandle.value = "other")),
  );
  expect(await active()).toBe("other");
  for (let i = 0; i < 3 && (await state())?.handles.length === 2; ++i) await user.press("Control+z").then(() => user.settle());
  expect(await active()).toBe(first);
  await step("Control+Shift+z", 2);
  expect(await active()).toBe("other");
});
