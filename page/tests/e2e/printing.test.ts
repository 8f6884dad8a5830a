import { readFileSync, writeFileSync } from "node:fs";
import type { Locator } from "playwright-core";
import { afterEach, expect, test } from "vitest";
import { EditorHarness, run, theme } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Returns the lengths of the box's sides. */
function sidesOf(positions: Float64Array): number[] {
  return [0, 1, 2].map((axis) => {
    const along = positions.filter((_, at) => at % 3 === axis);
    return Math.max(...along) - Math.min(...along);
  });
}

async function openPanel({ user }: EditorHarness): Promise<void> {
  const button = user.page.getByRole("region", { name: "Print" }).getByRole("button", { name: "Print" });
  if ((await button.getAttribute("aria-expanded")) !== "true") await button.click();
}

test("a check names what printers refuse, shows it, and offers the remedy", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bust", 60);
  const { user } = harness;
  const { page } = user;
  await openPanel(harness);
  const panel = page.getByRole("region", { name: "Print" });
  await panel.getByRole("button", { name: "Check", exact: true }).click();
  const rows = page.getByRole("list", { name: "Print check" }).getByRole("listitem");
  await rows.first().waitFor();
  expect(await rows.first().innerText()).toMatch(/Open: 1 hole/);
  expect((await rows.allInnerTexts()).some((text) => text.startsWith("Volume"))).toBe(false);
  await rows.filter({ hasText: "overhang" }).getByRole("button", { name: "Show" }).click();
  await user.rests();
  await user.screenshot(theme === "dark" ? "print-dark" : "editor_print.jpg");
  await rows.first().getByRole("button", { name: "Close" }).click();
  await user.rests();
  expect(await rows.count()).toBe(0); // the mesh has changed since
  await panel.getByRole("button", { name: "Check", exact: true }).click();
  await rows.first().waitFor();
  expect(await rows.first().innerText()).toMatch(/Closed/);
  expect((await rows.allInnerTexts()).some((text) => text.startsWith("Volume"))).toBe(true);
  expect(user.complaints).toEqual([]);
});

test("a part is checked by itself, and shown where it stands", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bar", 16);
  const { user } = harness;
  const { page } = user;
  await page.evaluate(() =>
    window.meshgraft.editor.ask({ do: "cut", halves: true, plane: { point: [0, 0, 0.5], normal: [0, 0, 1] } }),
  );
  await user.settle();
  await openPanel(harness);
  const panel = page.getByRole("region", { name: "Print" });
  await panel.getByRole("combobox", { name: "Object" }).selectOption("bar 2");
  await panel.getByRole("button", { name: "Check", exact: true }).click();
  const rows = page.getByRole("list", { name: "Print check" }).getByRole("listitem");
  await rows.first().waitFor();
  expect(await rows.first().innerText()).toMatch(/Open: 1 hole/);
  const sizeOf = (name: string) =>
    page.evaluate((name) => {
      const { editor, viewport } = window.meshgraft;
      const mesh = [editor.state.value!.model, ...editor.state.value!.parts].find((one) => one.name === name)!.mesh;
      return viewport.surfaceOf(mesh)!.size.z;
    }, name);
  const checkedHeight = () => page.evaluate(() => window.meshgraft.editor.printing.result.value?.size[2]);
  expect(await checkedHeight()).toBeCloseTo(await sizeOf("bar 2"), 5);
  await rows.first().getByRole("button", { name: "Show" }).click();
  await user.rests();
  expect(await page.evaluate(() => window.meshgraft.viewport.parts.shown().length)).toBe(1);
  const isSeen = (row: Locator) =>
    row.evaluate((row) => {
      const { top, bottom } = row.getBoundingClientRect();
      return top >= 0 && bottom <= innerHeight;
    });
  expect(await isSeen(rows.first())).toBe(true); // the list moved, as parts are shown among the panels of grafts
  await user.screenshot("print-part");
  await rows.first().getByRole("button", { name: "Close" }).click();
  await user.settle();
  await panel.getByRole("button", { name: "Check", exact: true }).click();
  await rows.first().waitFor();
  expect(await rows.first().innerText()).toMatch(/Closed/);
  await panel.getByRole("combobox", { name: "Object" }).selectOption({ label: "bar (the model)" });
  expect(await rows.count()).toBe(0);
  await panel.getByRole("button", { name: "Check", exact: true }).click();
  await rows.first().waitFor();
  expect(await rows.first().innerText()).toMatch(/Open: 1 hole/);
  expect(await checkedHeight()).toBeCloseTo(await sizeOf("bar"), 5);
  expect(user.complaints).toEqual([]);
});

test("a length measured by two clicks and typed anew scales the model, and undo takes it back", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bar", 12);
  const { user, folder } = harness;
  const { page } = user;
  const before = sidesOf(await harness.savedPositions());
  await user.press("Shift+M");
  const vertices = await page.evaluate(() => {
    const { positions, vertexCount } = window.meshgraft.viewport.main ?? { positions: new Float32Array(), vertexCount: 0 };
    const height = (v: number) => positions[3 * v + 2] ?? 0;
    const front = (v: number) => -(positions[3 * v + 1] ?? 0) - Math.abs(positions[3 * v] ?? 0);
    const at = (low: number, high: number) =>
      [...Array(vertexCount).keys()].filter((v) => height(v) > low && height(v) < high).sort((a, b) => front(b) - front(a))[0] ?? 0;
    return [at(-1.4, -0.6), at(0.6, 1.4)] as const;
  });
  for (const vertex of vertices) await user.clickAt(await user.screenOf(vertex));
  const field = page.getByRole("textbox", { name: "Length" });
  await field.waitFor();
  const measured = Number(await field.inputValue());
  expect(measured).toBeGreaterThan(0.5);
  await user.screenshot("printing-measured");
  await field.fill(String(10 * measured));
  await field.press("Enter");
  await user.settle();
  const scaled = sidesOf(await harness.savedPositions());
  scaled.forEach((side, k) => expect(side / (before[k] ?? 1)).toBeCloseTo(10, 2));
  expect(await field.count()).toBe(0);

  await page.evaluate(async (edit) => void (await window.meshgraft.editor.ask({ do: "save", edit })), folder.file("edit.json"));
  run("run", folder.file("edit.json"), "-o", folder.file("again.obj"));
  expect(readFileSync(folder.file("again.obj"), "utf8")).toBe(readFileSync(folder.file("saved.obj"), "utf8"));
  await user.press("Control+z");
  await user.settle();
  sidesOf(await harness.savedPositions()).forEach((side, k) => expect(side).toBeCloseTo(before[k] ?? 0, 6));
  expect(user.complaints).toEqual([]);
});

test("a point that was clicked before the model changed is forgotten", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bar", 12);
  const { user } = harness;
  const { page } = user;
  await user.press("Shift+M");
  const { x, y } = await page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
  });
  await page.mouse.move(x, y);
  await user.clickAt([x, y]);
  await page.mouse.move(x, y - 300); // beside the model
  const isShown = () => page.locator(".measured:not([display])").count();
  await expect.poll(isShown).toBe(1);
  await page.evaluate(async () => {
    await window.meshgraft.editor.ask({ do: "transform", pose: { translate: [1, 0, 0] } });
  });
  await user.rests();
  expect(await isShown()).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("another up axis checks the overhangs anew, and hides those of the old one", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bust", 30);
  const { user } = harness;
  const { page } = user;
  await openPanel(harness);
  await page.getByRole("region", { name: "Print" }).getByRole("button", { name: "Check", exact: true }).click();
  const row = page.getByRole("list", { name: "Print check" }).getByRole("listitem").filter({ hasText: "overhang" });
  await row.getByRole("button", { name: "Show" }).click();
  await row.getByRole("button", { name: "Hide" }).waitFor();
  const before = await row.innerText();
  await user.click("View");
  await page.getByRole("radiogroup", { name: "Up axis" }).getByText("Y", { exact: true }).click();
  await row.getByRole("button", { name: "Show" }).waitFor();
  await expect.poll(() => row.innerText()).not.toBe(before.replace("Hide", "Show"));
  await user.screenshot("printing-up");
  expect(user.complaints).toEqual([]);
});

test("a click on a face lays the model flat on it", async () => {
  harness = await EditorHarness.open({ dark: true });
  await harness.openSample("bar", 12);
  const { user } = harness;
  const { page } = user;
  const before = sidesOf(await harness.savedPositions());
  await user.press("Shift+L");
  const { x, y } = await page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
  });
  await page.mouse.move(x, y);
  await user.clickAt([x, y]);
  await user.rests();
  const positions = await harness.savedPositions();
  const after = sidesOf(positions);
  expect(after[2]).toBeLessThan(0.5 * (before[2] ?? 0)); // it stood upright
  expect(Math.min(...positions.filter((_, at) => at % 3 === 2))).toBeCloseTo(0, 4);
  await user.screenshot("printing-flat");
  await page.getByRole("button", { name: "Steps", exact: false }).first().click();
  expect(await page.getByRole("button", { name: "1. Size and place" }).count()).toBeGreaterThan(0);
  expect(user.complaints).toEqual([]);
});

test("the export dialog says what the file will hold, and warns", async () => {
  harness = await EditorHarness.open();
  await harness.openSample("bust", 30);
  const { user } = harness;
  const { page } = user;
  await user.press("Control+e");
  const dialog = page.getByRole("dialog");
  const warnings = dialog.getByRole("list", { name: "Warnings" });
  await warnings.waitFor();
  expect(await warnings.innerText()).toMatch(/Open: 1 hole/);
  expect(await dialog.innerText()).toMatch(/names no unit/);
  await user.screenshot(`printing-export-${theme}`);
  await dialog.getByRole("combobox", { name: "Format" }).selectOption(".3mf");
  expect(await dialog.innerText()).toMatch(/The file says mm/);
  expect(user.complaints).toEqual([]);
});

test("the export dialog tells of self-intersections and thin walls, and checks a large mesh when asked to", async () => {
  harness = await EditorHarness.open({ files: { "bar.obj": ["bar", "--resolution", "8"] } });
  const { user, folder } = harness;
  const { page } = user;
  const lines = readFileSync(folder.file("bar.obj"), "utf8").split("\n");
  const vertices = lines.filter((line) => line.startsWith("v ")).map((line) => line.split(/\s+/).slice(1, 4).map(Number));
  const faces = lines.filter((line) => line.startsWith("f ")).map((line) => line.split(/\s+/).slice(1, 4).map((corner) => parseInt(corner)));
  const moved = vertices.map(([x = 0, y = 0, z = 0]) => `v ${x + 0.53} ${y + 0.31} ${z + 0.17}`);
  const both = [...vertices.map((at) => `v ${at.join(" ")}`), ...moved];
  const again = faces.map((corners) => `f ${corners.map((corner) => corner + vertices.length).join(" ")}`);
  writeFileSync(folder.file("crossed.obj"), [...both, ...faces.map((corners) => `f ${corners.join(" ")}`), ...again, ""].join("\n"));
  await harness.openFile(folder.file("crossed.obj"));
  await page.evaluate(() => {
    window.meshgraft.editor.printing.leastWall.value = 2; // the bar is 1 wide
    window.meshgraft.editor.printing.mostFacesUnasked.value = 100;
  });
  await user.press("Control+e");
  const dialog = page.getByRole("dialog");
  await dialog.getByText("This large mesh is not checked yet").waitFor();
  expect(await dialog.getByRole("list", { name: "Warnings" }).count()).toBe(0);
  await dialog.getByRole("button", { name: "Check", exact: true }).click();
  const warnings = dialog.getByRole("list", { name: "Warnings" });
  await warnings.waitFor();
  expect(await warnings.innerText()).toMatch(/self-intersecting pairs of faces: print shops refuse this/);
  expect(await warnings.innerText()).toMatch(/Thinnest wall [\d.]+, below 2/);
  expect(await dialog.getByText("is not checked yet").count()).toBe(0);
  await user.screenshot("printing-export-crossed");
  expect(user.complaints).toEqual([]);
});
