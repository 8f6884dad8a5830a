import { afterEach, expect, test } from "vitest";
import { cutOff } from "./cut_off";
import { EditorHarness, theme, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

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
});

test("the start screen of a narrow window shows files before samples", async () => {
  harness = await EditorHarness.open({ size: { width: 800, height: 600 }, files: { "scan.ply": ["bar", "--resolution", "8"] } });
  const { user } = harness;
  const { page } = user;
  await page.getByRole("list", { name: "Your models" }).locator("img.thumbnail").first().waitFor();
  await user.screenshot("small-window-start");
  const top = (title: string) =>
    page.getByRole("heading", { name: title }).evaluate((heading) => heading.getBoundingClientRect().top);
  expect(await top("From this computer")).toBeLessThan(await top("Samples"));
  expect(await cutOff(user, ".start")).toEqual([]);
});

/** Returns the grips of the gizmo, and the reach, that something else covers. */
function coveredGrips(user: User): Promise<string[]> {
  return user.page.evaluate(() => {
    const { canvas } = window.meshgraft.viewport;
    const box = canvas.getBoundingClientRect();
    const isCovered = ({ x, y }: DOMPoint) =>
      x > box.left && x < box.right && y > box.top && y < box.bottom && document.elementFromPoint(x, y) !== canvas;
    const grips = [...document.querySelectorAll<SVGGElement>(".gizmo:not([display]) > [data-part]:not([display])")];
    const found = grips.filter((grip) => {
      const line = grip.querySelector<SVGPathElement>(".line");
      const map = line?.getScreenCTM();
      if (line === null || map === null || map === undefined) return false;
      const length = line.getTotalLength();
      return Array.from({ length: 24 }, (_, k) => line.getPointAtLength((k / 24) * length).matrixTransform(map)).some(isCovered);
    });
    const knob = document.querySelector(".reach:not([display]) .reach-knob")?.getBoundingClientRect();
    const isKnobCovered = knob !== undefined && isCovered(new DOMPoint(knob.x + knob.width / 2, knob.y + knob.height / 2));
    return [...found.map((grip) => grip.dataset["part"] ?? "?"), ...(isKnobCovered ? ["reach"] : [])];
  });
}

test("bars give way to the grips of the gizmo, whose size fits the handle", async () => {
  harness = await EditorHarness.open({ size: { width: 800, height: 600 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("octopus", 40);
  await user.press("Shift+s");
  const outerRing = async (select: unknown, name: string) => {
    await page.evaluate(
      async ([select, name]) => {
        const { editor } = window.meshgraft;
        await editor.ask({ do: "handle", what: "add", name, select: select as string, reach: 0.4 });
        editor.tools.activeHandle.value = name;
      },
      [select, name] as const,
    );
    await user.rests();
    return page.evaluate(() => document.querySelector('[data-part="view-ring"] .line')?.getBoundingClientRect().width ?? 0);
  };
  const large = await outerRing({ half_space: { point: [0, 0, 0.35], normal: [0, 0, 1] } }, "head");
  const small = await outerRing({ nearest: [1.6, 0, 0] }, "tip");
  expect(large).toBeGreaterThan(1.2 * small);
  expect(small).toBeGreaterThan(150); // its grips stay apart

  for (const handle of ["head", "tip"])
    for (const key of ["1", "3", "7", "f"]) {
      await page.evaluate((name) => (window.meshgraft.editor.tools.activeHandle.value = name), handle);
      await user.press(key);
      await user.rests();
      if (key === "f" || key === "1") await user.screenshot(`small-window-grips-${handle}-${key}-${theme}`);
      expect(await coveredGrips(user), `${handle}, ${key}`).toEqual([]);
    }
  expect(user.complaints).toEqual([]);
});

test("a field that refuses a number says why, and the words cover nothing", async () => {
  harness = await EditorHarness.open({ size: { width: 800, height: 600 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 3], normal: [0, 0, 1] } }, reach: 1 });
    editor.tools.activeHandle.value = "top";
  });
  await user.settle();
  const field = page.getByRole("textbox", { name: "Scale", exact: true });
  await field.fill("-1");
  await field.press("Enter");
  const says = page.getByRole("alert").filter({ hasText: "Enter a number above 0." });
  await says.waitFor();
  await user.screenshot("small-window-refused");
  const covered = await says.evaluate((one) => {
    const { left, right, top, bottom } = one.getBoundingClientRect();
    return [...document.querySelectorAll(".side input, .side button")].filter((other) => {
      const box = other.getBoundingClientRect();
      return box.width > 0 && box.left < right && box.right > left && box.top < bottom && box.bottom > top;
    }).length;
  });
  expect(covered).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("in the window of a phone, the panels lie over the view and every button is in reach", async () => {
  harness = await EditorHarness.open({ size: { width: 390, height: 800 } });
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  await user.screenshot("phone");
  for (const name of ["Save", "Export", "Panels", "Help"]) {
    const box = await page.locator(".header").getByRole("button", { name: new RegExp(`^${name}`) }).first().boundingBox();
    expect((box?.x ?? 0) + (box?.width ?? Infinity), name).toBeLessThanOrEqual(390);
  }
  const width = () => page.evaluate(() => document.querySelector(".view")?.clientWidth ?? 0);
  expect(await width()).toBeGreaterThan(300);
  await user.click("Panels");
  await page.getByRole("complementary", { name: "Panels" }).waitFor({ state: "detached" });
  await user.settle();
  await user.screenshot("phone-folded");

  const camera = () => page.evaluate(() => window.meshgraft.viewport.camera.position.toArray());
  for (const size of [{ width: 40, height: 700 }, { width: 1280, height: 60 }]) {
    await page.setViewportSize(size);
    await page.waitForTimeout(100);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
  await user.settle();
  expect((await camera()).every(Number.isFinite)).toBe(true);
  await user.screenshot("phone-widened");
  expect(user.complaints).toEqual([]);
});
