// Drives the page by emulated fingers and an emulated pen.
import type { CDPSession } from "playwright-core";
import { afterEach, expect, test } from "vitest";
import { cutOff } from "./cut_off";
import { grafted } from "./grafting";
import { aimAt, farthest, openFresh, sampled, selectedIn } from "./grips";
import { EditorHarness, type Point, theme, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Returns what can be pressed and is narrower or lower than 44 pixels, with its size. */
function smallTargets({ page }: User): Promise<string[]> {
  return page.evaluate(() => {
    const pressed = "button, select, input:not([type=range], .hidden *), summary, .segments label, .toggle";
    const boxOf = (one: Element) => (one.closest(".toggle, .segments label, .link, .number") ?? one).getBoundingClientRect();
    return [...document.querySelectorAll(pressed)]
      .filter((one) => one.getClientRects().length > 0 && one.closest(".view-cube-sides") === null)
      .map((one) => ({ one, box: boxOf(one) }))
      .filter(({ box }) => box.width < 43.5 || box.height < 43.5)
      .map(({ one, box }) => `${one.getAttribute("aria-label") ?? one.textContent ?? one.localName}: ${box.width.toFixed(0)} × ${box.height.toFixed(0)}`);
  });
}

test("what fingers press is 44 pixels wide and high", async () => {
  harness = await EditorHarness.open({ touch: true, size: { width: 1180, height: 820 } });
  const { user } = harness;
  const { page } = user;
  expect(await page.evaluate(() => matchMedia("(pointer: coarse)").matches)).toBe(true);
  expect(await smallTargets(user)).toEqual([]);
  await harness.openSample("bust", 30);
  const folded = page.locator(".section h2 button[aria-expanded=false], .more-button[aria-expanded=false]");
  while ((await folded.count()) > 0) await folded.first().tap();
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "select", how: "set", what: { grow_length: { of: { nearest: [0, -0.5, 0] }, length: 0.3 } } });
    await editor.ask({ do: "group", name: "throat" });
    await editor.ask({ do: "handle", what: "add", name: "held", select: "throat", reach: 0.4 });
    editor.tools.activeHandle.value = "held";
    editor.tools.snap.value = true;
    editor.note("Saved", "a.json", "A remedy.");
  });
  await user.settle();
  for (const tool of ["handle", "brush", "flood"]) {
    await page.evaluate((tool) => (window.meshgraft.editor.tools.tool.value = tool as never), tool);
    expect(await smallTargets(user), tool).toEqual([]);
  }
  await user.rests();
  await user.screenshot(`touch-${theme}`);
  await page.evaluate(() => window.meshgraft.editor.dismissMessages());
  await page.getByRole("button", { name: "File menu of meshgraft" }).tap();
  expect(await smallTargets(user), "menu").toEqual([]);
  await user.screenshot(`touch-menu-${theme}`);
  await page.getByRole("menuitem", { name: /^Save as…/ }).tap();
  await page.getByRole("dialog").waitFor();
  expect(await smallTargets(user), "dialog").toEqual([]);
  await page.getByRole("dialog").getByRole("button", { name: "Cancel" }).tap();
  await page.getByRole("tab", { name: "Graft" }).tap();
  await page.getByRole("button", { name: "Add head" }).tap();
  await page.waitForFunction(() => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value !== null);
  while ((await folded.count()) > 0) await folded.first().tap();
  expect(await smallTargets(user), "graft").toEqual([]);
  await user.rests();
  await user.screenshot(`touch-graft-${theme}`);
  expect(user.complaints).toEqual([]);
});

test.each([
  [800, 600],
  [1024, 768],
])("no panel cuts anything off on a touched screen of %i × %i", async (width, height) => {
  harness = await EditorHarness.open({ touch: true, size: { width, height } });
  const { user } = harness;
  const { page } = user;
  const shot = (name: string) => user.screenshot(`touch-${width}-${name}-${theme}`);
  const bars = ".header, .tool-line, .side, .status, .toolbar, .messages";
  const folded = page.locator(".section h2 button[aria-expanded=false], .more-button[aria-expanded=false]");
  const check = async (name: string) => {
    while ((await folded.count()) > 0) await folded.first().tap();
    await user.rests();
    expect.soft(await cutOff(user, bars), name).toEqual([]);
  };
  await harness.openSample("bust", 20);
  await check("no handle");
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "select", how: "set", what: { grow_length: { of: { nearest: [0, -0.5, 0] }, length: 0.3 } } });
    await editor.ask({ do: "group", name: "throat" });
    await editor.ask({ do: "handle", what: "add", name: "held", select: "throat", reach: 0.4 });
    await editor.pose({ held: { rotate: { axis: [1, 1, 0], angle_deg: 725 }, scale: [1, 1.25, 1] } });
    await editor.printing.check();
    editor.tools.activeHandle.value = "held";
    editor.tools.snap.value = true;
  });
  await check("a handle");
  await page.getByRole("group", { name: "Rotate" }).scrollIntoViewIfNeeded();
  await shot("rotate");
  await page.getByRole("tab", { name: "Graft" }).tap();
  await check("no part");
  await page.getByRole("button", { name: "Add head" }).tap();
  await page.waitForFunction(() => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value !== null);
  await check("graft");
  await shot("graft");
  expect(user.complaints).toEqual([]);
});

test("hints speak of fingers where fingers are used, and of the mouse where it is", async () => {
  harness = await EditorHarness.open({ touch: true, size: { width: 1180, height: 820 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 12);
  await page.getByText("Drag to orbit, two fingers to pan and zoom.").waitFor();
  await page.getByRole("button", { name: "Point handle" }).tap();
  await page.getByText("Tap a vertex to make it a handle.").waitFor();
  await page.touchscreen.tap(450, 420);
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles.length === 1);
  await user.click("Curve handle"); // by the mouse
  await page.getByText(/^Click points along the curve/).waitFor();
  expect(await page.getByRole("button", { name: "Finish" }).count()).toBe(0);
  await page.getByRole("button", { name: "Curve handle" }).tap();
  await page.getByRole("button", { name: "Finish" }).waitFor();
  expect(user.complaints).toEqual([]);
});

/** Draws with a pen that presses this hard. */
async function drawWithPen(pen: CDPSession, [from, to]: readonly [Point, Point], force: number): Promise<void> {
  const at = ([x, y]: Point) => ({ x, y, pointerType: "pen", button: "left", force }) as const;
  await pen.send("Input.dispatchMouseEvent", { type: "mousePressed", ...at(from), buttons: 1, clickCount: 1 });
  for (let k = 1; k <= 4; ++k) {
    const point: Point = [from[0] + (k / 4) * (to[0] - from[0]), from[1] + (k / 4) * (to[1] - from[1])];
    await pen.send("Input.dispatchMouseEvent", { type: "mouseMoved", ...at(point), buttons: 1 });
  }
  await pen.send("Input.dispatchMouseEvent", { type: "mouseReleased", ...at(to), buttons: 0, clickCount: 1 });
}

test("the pressure of a pen sizes the brush", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  await openFresh(harness, "head");
  const pen = await user.page.context().newCDPSession(user.page);
  await user.press("1");
  await user.rests();
  const nose = await aimAt(user, farthest(sampled(harness, "head"), [0, -1, 0]));
  await user.press("b");
  const painted = async (force: number) => {
    await drawWithPen(pen, [nose, [nose[0] + 10, nose[1] + 14]], force);
    await user.settle();
    const count = (await selectedIn(user)).length;
    await user.press("Alt+a");
    await user.settle();
    return count;
  };
  const [light, usual, firm] = [await painted(0.2), await painted(0.5), await painted(1)];
  expect(light).toBeGreaterThan(0);
  expect(usual).toBeGreaterThan(1.5 * light);
  expect(firm).toBeGreaterThan(1.5 * usual);
  expect(user.complaints).toEqual([]);
});

test("a finger scrolls the part library, and drags a part sideways onto the surface", async () => {
  harness = await EditorHarness.open({ touch: true, size: { width: 1024, height: 600 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bust", 30);
  await page.getByRole("tab", { name: "Graft" }).tap();
  const hand = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", points: readonly Point[]) =>
    hand.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  const swipe = async ([x, y]: Point, [dx, dy]: Point) => {
    await touch("touchStart", [[x, y]]);
    for (let k = 1; k <= 10; ++k) await touch("touchMove", [[x + (k / 10) * dx, y + (k / 10) * dy]]);
    await touch("touchEnd", []);
  };
  const middleOf = async (name: string): Promise<Point> => {
    const box = (await page.getByRole("button", { name, exact: true }).boundingBox())!;
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const isSeen = ([, y]: Point) => y > 80 && y < 560;
  await user.rests();
  const before = await middleOf("Add head");
  expect(isSeen(before)).toBe(true);
  await swipe(before, [0, -120]);
  await expect.poll(async () => before[1] - (await middleOf("Add head"))[1]).toBeGreaterThan(60);
  const stands = async () => {
    const [, y] = await middleOf("Add head");
    await user.rests();
    return (await middleOf("Add head"))[1] === y;
  };
  await expect.poll(stands).toBe(true); // a finger that comes down while the list still moves only stops it
  expect(await page.evaluate(() => window.meshgraft.editor.graft.parts.value.length)).toBe(0);

  const at = await middleOf("Add octopus");
  expect(isSeen(at)).toBe(true);
  const chest = await aimAt(user, farthest(sampled(harness, "bust", 30), [0, -1, 0]));
  await swipe(at, [chest[0] - at[0], chest[1] - at[1]]);
  await page.waitForFunction(() => window.meshgraft.editor.isIdle() && window.meshgraft.editor.state.value?.graft !== null);
  await user.rests();
  await user.screenshot(`touch-dropped-${theme}`);
  expect(user.complaints).toEqual([]);
});

test("a finger changes the height and the tilt of a closed part's base once it is lifted", async () => {
  harness = await EditorHarness.open({ touch: true, size: { width: 1180, height: 820 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 20);
  await page.getByRole("tab", { name: "Graft" }).tap();
  await user.rests();
  const hand = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", points: readonly Point[]) =>
    hand.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  const swipe = async ([x, y]: Point, [dx, dy]: Point, meanwhile = () => Promise.resolve()) => {
    await touch("touchStart", [[x, y]]);
    for (let k = 1; k <= 10; ++k) await touch("touchMove", [[x + (k / 10) * dx, y + (k / 10) * dy]]);
    await meanwhile();
    await touch("touchEnd", []);
  };
  const card = page.getByRole("button", { name: "Add cactus", exact: true });
  await card.scrollIntoViewIfNeeded();
  const box = (await card.boundingBox())!;
  const at: Point = [box.x + box.width / 2, box.y + box.height / 2];
  const side: Point = await page.evaluate(() => {
    const { viewport } = window.meshgraft;
    const { x, y } = viewport.project(viewport.main!.sphere().center);
    return [x, y] as const;
  });
  await swipe(at, [side[0] - at[0], side[1] - at[1]], async () => {
    await page.getByText(/lift the finger to graft, then drag the grips of its base/).first().waitFor();
    await user.screenshot(`touch-base-dragged-${theme}`);
  });
  await grafted(user);
  await page.getByText(/^With a finger, drag the blue grips/).waitFor();
  await user.rests();
  await user.screenshot(`touch-base-${theme}`);

  const base = () => page.evaluate(() => window.meshgraft.editor.graft.kept.value?.at?.base);
  const found = await page.evaluate(() => window.meshgraft.editor.graft.report.value?.base?.height ?? 0);
  const along = await page.locator(".base-stem").evaluate((stem) => {
    const path = stem as SVGPathElement;
    const [from, to] = [path.getPointAtLength(0), path.getPointAtLength(path.getTotalLength())] as const;
    const length = Math.hypot(to.x - from.x, to.y - from.y);
    return [(to.x - from.x) / length, (to.y - from.y) / length] as const;
  });
  /** Drags from the edge of a grip, 20 pixels beside its middle, by so many pixels along the stem. */
  const dragGrip = async (grip: string, px: number) => {
    const knob = (await page.locator(`.base-knob.${grip} .halo`).boundingBox())!;
    expect(Math.min(knob.width, knob.height)).toBeGreaterThanOrEqual(44);
    const from: Point = [knob.x + knob.width / 2 + 20 * along[1], knob.y + knob.height / 2 - 20 * along[0]];
    await swipe(from, [px * along[0], px * along[1]]);
    await grafted(user);
  };
  await dragGrip("height", 8);
  expect((await base())?.height).toBeGreaterThan(found);
  await dragGrip("tilt", 16);
  expect((await base())?.tilt_deg).not.toBe(0);
  await user.rests();
  await user.screenshot(`touch-base-changed-${theme}`);
  expect(user.complaints).toEqual([]);
}, 180_000);
