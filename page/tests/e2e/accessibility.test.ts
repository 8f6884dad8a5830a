// Checks by axe-core what screen readers and the keyboard get, and drives the page without a pointer.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { afterEach, expect, test } from "vitest";
import { damage } from "./damaged";
import { grafted } from "./grafting";
import { EditorHarness, Engine, freePort, type User } from "./harness";
import { poseOf, selectedIn } from "./grips";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

interface Violation {
  id: string;
  nodes: { html: string; failureSummary: string }[];
}

/** Returns what axe-core finds on the page, a line for each element. */
async function violationsOf(user: User): Promise<string[]> {
  await user.page.evaluate(axe);
  const found = await user.page.evaluate(async () => {
    const { axe } = window as unknown as { axe: { run(): Promise<{ violations: Violation[] }> } };
    return (await axe.run()).violations;
  });
  return found.flatMap(({ id, nodes }) => nodes.map(({ html, failureSummary }) => `${id}: ${html} ${failureSummary}`));
}

const tools = ["navigate", "handle", "vertex", "curve", "brush", "lasso", "box", "connected", "loop", "flood", "measure", "flat"];

async function openAllSections({ page }: User): Promise<void> {
  const folded = page.locator(".section h2 button[aria-expanded=false], .more-button[aria-expanded=false]");
  while ((await folded.count()) > 0) await folded.first().click();
}

test.each([false, true])("axe-core finds nothing on the page (dark: %s)", async (dark) => {
  harness = await EditorHarness.open({ dark });
  const { user } = harness;
  const { page } = user;
  const check = async (state: string) => expect.soft(await violationsOf(user), state).toEqual([]);
  await page.waitForFunction(() => document.querySelectorAll(".cards li").length >= 12);
  await check("start screen");

  await harness.openSample("bust", 30);
  await openAllSections(user);
  await check("model, all panels open");
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "select", how: "set", what: { grow_length: { of: { nearest: [0, -0.5, 0] }, length: 0.3 } } });
    await editor.ask({ do: "group", name: "top", colour: "#aa3355" });
    await editor.ask({ do: "handle", what: "add", name: "held", select: "top", reach: 0.4 });
    editor.tools.activeHandle.value = "held";
    editor.tools.snap.value = true;
  });
  await user.settle();
  expect(await page.evaluate(() => window.meshgraft.editor.messages.value.length)).toBe(0);
  for (const tool of tools) {
    await page.evaluate((name) => (window.meshgraft.editor.tools.tool.value = name as never), tool);
    await check(`tool ${tool}`);
  }
  await user.screenshot(`accessible-tools-${dark ? "dark" : "light"}`);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.printing.check();
    await editor.ask({ do: "accept" });
    editor.note("Saved", "a.json", "A remedy.");
    editor.tell("problem", { problem: "A problem", location: "a.json", remedy: "A remedy." });
  });
  await user.settle();
  await check("messages and a print check");
  await user.press("Escape");

  for (const [keys, name] of [["Control+o", "Open"], ["Control+s", "Save the edit file"], ["Control+e", "Export the mesh"], ["?", "Help"]] as const) {
    await user.press(keys);
    await page.getByRole("dialog", { name }).waitFor();
    await check(`dialog ${name}`);
    await user.press("Escape");
    await page.getByRole("dialog", { name }).waitFor({ state: "detached" });
  }
  await page.getByRole("button", { name: "File menu of meshgraft" }).click();
  await check("menu");
  await user.press("Escape");

  await page.getByRole("tab", { name: "Graft" }).click();
  await openAllSections(user);
  await check("graft, before a part");
  await user.click("Add head");
  await page.waitForFunction(() => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value !== null);
  await openAllSections(user);
  await check("graft");
  await user.screenshot(`accessible-graft-${dark ? "dark" : "light"}`);
  expect(user.complaints).toEqual([]);
}, 180_000);

test.each([false, true])("axe-core finds nothing in the guided tour (dark: %s)", async (dark) => {
  harness = await EditorHarness.open({ firstStart: true, dark });
  const { user } = harness;
  await user.page.getByRole("dialog", { name: "Open a model" }).waitFor();
  expect.soft(await violationsOf(user), "the first bubble").toEqual([]);
  await user.page.getByRole("button", { name: "Open bust" }).click();
  await user.page.getByRole("dialog", { name: "Graft another one onto it" }).waitFor();
  await user.rests();
  await user.page.getByRole("button", { name: "Next" }).click(); // a button that is off
  await user.page.getByRole("dialog", { name: "Change it, and accept it" }).waitFor();
  expect(await violationsOf(user), "a later bubble").toEqual([]);
});

test.each([false, true])("axe-core finds nothing on defects, the question of the unit and an offer to restore (dark: %s)", async (dark) => {
  const port = await freePort();
  harness = await EditorHarness.open({ dark, files: { "bust.obj": ["bust", "--resolution", "40"] }, words: ["--port", port] });
  const { user, folder } = harness;
  const { page } = user;
  const check = async (state: string) => expect.soft(await violationsOf(user), state).toEqual([]);
  await page.getByRole("list", { name: "Your models" }).locator("img.thumbnail").waitFor();
  await check("start screen with own models");
  await page.getByRole("searchbox").fill("no such");
  await page.getByText("Nothing has this name.").waitFor();
  await check("start screen where nothing is found");

  damage(folder.file("bust.obj"));
  await page.evaluate((path) => window.meshgraft.editor.open({ do: "open", path }), folder.file("bust.obj"));
  await user.opened();
  await page.getByRole("list", { name: "Defects of bust" }).waitFor();
  await page.getByRole("region", { name: "Unit of the model" }).waitFor();
  await check("defects, and the question of the unit");
  await page.getByRole("list", { name: "Defects of bust" }).getByRole("button", { name: "Show" }).first().click();
  await user.rests();
  await check("defects lit up");
  await user.screenshot(`accessible-defects-${dark ? "dark" : "light"}`);

  await page.evaluate(async () => void (await window.meshgraft.editor.ask({ do: "paint-handle", vertices: [0], name: "tip" })));
  await harness.engine.stop("SIGKILL");
  await page.getByText("meshgraft does not answer").waitFor();
  await check("the connection is lost");
  harness.engine = await Engine.start(["--port", port, folder.file("bust.obj")]);
  await page.getByText("meshgraft was restarted").waitFor();
  await check("the engine was started again");
  page.once("dialog", (dialog) => void dialog.accept());
  await page.goto(harness.engine.url);
  await page.getByText("Restore unsaved work?").waitFor();
  await check("an offer to restore");
  await user.screenshot(`accessible-restore-${dark ? "dark" : "light"}`);
});

test.each([false, true])("axe-core finds nothing where several rotations are to choose from (dark: %s)", async (dark) => {
  harness = await EditorHarness.open({ dark });
  const { user } = harness;
  await harness.openSample("bust", 40);
  await user.page.evaluate(() => window.meshgraft.editor.graft.addPart({ sample: "head", resolution: 40 }).then(() => undefined));
  await user.page.evaluate(() => void (window.meshgraft.editor.graft.mode.value = "graft"));
  await grafted(user);
  await user.page.getByRole("group", { name: "Rotations of pair 1" }).getByRole("button").first().waitFor();
  await user.rests();
  expect(await violationsOf(user)).toEqual([]);
  await user.screenshot(`accessible-rotations-${dark ? "dark" : "light"}`);
});

/** Returns what is read out to those who do not see the page. */
const announced = ({ page }: User) => page.getByRole("status", { name: "What was done" }).innerText();

async function focusView(user: User): Promise<void> {
  await user.page.getByRole("application", { name: "View of the model" }).focus();
}

test("the surface is picked, painted and posed by the arrow keys", async () => {
  harness = await EditorHarness.open({ dark: true });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 20);
  await focusView(user);
  await user.press("ArrowLeft"); // the cursor begins in the middle
  expect(await announced(user)).toMatch(/^On the model/);
  await user.press("b");
  await user.press("Space");
  expect(await announced(user)).toMatch(/^The stroke begins/);
  for (let k = 0; k < 3; ++k) await user.press("ArrowUp");
  await user.screenshot("editor_cursor.jpg");
  await user.press("Space");
  await expect.poll(() => announced(user)).toMatch(/vertices selected/);
  expect((await selectedIn(user)).length).toBeGreaterThan(3);

  await user.press("p");
  await user.press("Shift+ArrowUp");
  await user.press("Space"); // a point handle
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles.length === 1);
  await expect.poll(() => announced(user)).toBe("handle 1 is made.");
  await user.rests();
  await user.press("ArrowDown");
  await user.press("ArrowUp");
  expect(await announced(user)).toBe("Ball: moves.");
  await user.press("Space");
  for (let k = 0; k < 3; ++k) await user.press("ArrowRight");
  await user.press("Space");
  await user.settle();
  expect((await poseOf(user))?.translate).toBeDefined();
  await expect.poll(() => announced(user)).toBe("handle 1: moved.");
  await user.press("Control+z");
  await expect.poll(() => announced(user)).toBe("Undone: move.");

  const camera = () => page.evaluate(() => window.meshgraft.viewport.camera.position.toArray());
  const before = await camera();
  await user.press("Control+ArrowRight");
  await user.press("PageUp");
  await user.rests();
  expect(await camera()).not.toEqual(before);
  expect(user.complaints).toEqual([]);
});

test("the view cube is one stop of the tab key, with six names", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  const group = page.getByRole("radiogroup", { name: "View from" });
  const names = await group.getByRole("radio").evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
  expect(names).toEqual(["Front", "Back", "Right", "Left", "Top", "Bottom"]);
  await focusView(user);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Space");
  await user.rests();
  const looksAlong = () => page.evaluate(() => window.meshgraft.viewport.camera.getWorldDirection(window.meshgraft.viewport.navigation.target.clone()).toArray());
  expect((await looksAlong())[1]).toBeCloseTo(1, 5);
  for (let k = 0; k < 4; ++k) await page.keyboard.press("ArrowDown");
  await user.rests();
  expect(await group.getByRole("radio", { name: "Top" }).isChecked()).toBe(true);
  expect((await looksAlong())[2]).toBeCloseTo(-1, 5);
  await user.screenshot("accessible-cube");
  await page.keyboard.press("Tab");
  expect(await page.evaluate(() => document.activeElement?.closest(".view-cube") ?? null)).toBeNull();
  expect(user.complaints).toEqual([]);
});

test("whatever tab comes to shows that it has the focus", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  await openAllSections(user);
  await page.locator(".panels").evaluate((panels) => panels.scrollTo(0, 0));
  await page.getByRole("button", { name: "File menu of meshgraft" }).focus();
  const hidden: string[] = [];
  for (let k = 0; k < 90; ++k) {
    await page.keyboard.press("Tab");
    const unseen = await page.evaluate(() => {
      const one = document.activeElement;
      if (one === null || one === document.body) return "";
      const isOutlined = (element: Element | null) => element !== null && getComputedStyle(element).outlineStyle !== "none";
      const seen = [one, one.closest("label"), one.closest(".view-cube")].some(isOutlined) || one.closest(".number:focus-within") !== null;
      return seen ? "" : one.outerHTML.slice(0, 120);
    });
    if (unseen !== "") hidden.push(unseen);
  }
  expect(hidden).toEqual([]);
});
