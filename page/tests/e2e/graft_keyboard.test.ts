// Grafts and cuts by keys alone.
import { afterEach, expect, test } from "vitest";
import { close, grafted, graftOf, open, saved, watertight } from "./grafting";
import { theme, type User } from "./harness";
import { tabTo } from "./tab_to";

afterEach(close);

const farthestTab = 150; // the library lists a dozen samples, each with two buttons

declare global {
  interface Window {
    pointerEvents: number;
    told: string[];
  }
}

/** Opens a sample from the start screen and the mode Graft, and notes pointer events and what screen readers are told. */
async function openByKeys(sample: string) {
  const opened = await open({
    before: (page) =>
      page.addInitScript(() => {
        window.pointerEvents = 0;
        window.told = [];
        for (const event of ["pointerdown", "pointermove", "wheel"])
          window.addEventListener(event, () => ++window.pointerEvents, { capture: true });
        new MutationObserver(() => {
          const words = document.querySelector('[aria-label="What was done"]')?.textContent ?? "";
          if (words !== "" && window.told.at(-1) !== words) window.told.push(words);
        }).observe(document, { subtree: true, childList: true, characterData: true });
      }),
  });
  const { user } = opened;
  await tabTo(user, new RegExp(`^${sample}`));
  await user.press("Enter");
  await user.opened();
  await tabTo(user, /^Deform$/);
  await user.press("ArrowRight");
  await user.rests();
  return opened;
}

const told = (user: User) => user.page.evaluate(() => window.told);
const whenTold = (user: User, words: RegExp) => expect.poll(() => told(user), { timeout: 60_000 }).toContainEqual(expect.stringMatching(words));
const pointerEvents = (user: User) => user.page.evaluate(() => window.pointerEvents);

test("a part is dropped from the library onto the surface by keys, and the drop is cancelled", async () => {
  const { harness, user } = await openByKeys("bar");
  const { page } = user;
  const place = () => page.evaluate(() => (window.meshgraft.editor.graft.dragged.value?.at as { point: number[] } | undefined)?.point);
  const begin = async () => {
    await tabTo(user, /^Drop head on the surface$/, farthestTab);
    await user.press("Enter");
    await whenTold(user, /^head follows the cursor over the surface/);
    await expect.poll(place, { timeout: 60_000 }).toBeDefined();
    expect(await page.evaluate(() => document.activeElement === window.meshgraft.viewport.canvas)).toBe(true);
  };
  await begin();
  const first = await place();
  await user.press("ArrowUp");
  await whenTold(user, /^head on bar, at /);
  const second = await place();
  expect(second).not.toEqual(first);
  await user.press("r");
  await whenTold(user, /^Spin 15 degrees/);
  await page.waitForFunction(() => window.meshgraft.editor.graft.preview.value !== null, undefined, { timeout: 90_000 });
  await user.rests();
  await user.screenshot(`keys-drop-${theme}`);
  await user.press("Escape");
  await whenTold(user, /^Cancelled: head is not grafted/);
  await page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 0 && window.meshgraft.editor.isIdle());
  expect(await graftOf(user)).toBeNull();

  await begin();
  await user.press("ArrowUp");
  const last = await place();
  await user.press("Space");
  expect((await grafted(user))?.error).toBeUndefined();
  await whenTold(user, /^head is on the surface/);
  expect(await graftOf(user)).toMatchObject({ source: "head", at: { point: last } });
  await user.rests();
  await user.screenshot(`keys-dropped-${theme}`);
  await user.press("Control+Enter");
  await user.settle();
  expect(await graftOf(user)).toBeNull();
  expect(await saved(harness)).toMatchObject(watertight);
  expect(await pointerEvents(user)).toBe(0);
  expect(user.complaints).toEqual([]);
}, 240_000);

test("Enter grafts a part that keys have dropped, too, but not beside the model", async () => {
  const { user } = await openByKeys("bar");
  await tabTo(user, /^Drop head on the surface$/, farthestTab);
  await user.press("Enter");
  await whenTold(user, /^head follows the cursor/);
  const moveUntilTold = async (key: string, words: RegExp) => {
    for (let step = 0; step < 40 && !words.test((await told(user)).at(-1) ?? ""); ++step) await user.press(key);
    await whenTold(user, words);
  };
  await moveUntilTold("Shift+ArrowRight", /^Beside the model\.$/);
  await user.press("Enter");
  await whenTold(user, /^Beside the model\. Move the part back/);
  expect(await graftOf(user)).toBeNull();
  await moveUntilTold("Shift+ArrowLeft", /^head on bar/);
  await user.press("Enter");
  await grafted(user);
  await whenTold(user, /^head is on the surface/);
  expect(await pointerEvents(user)).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("loops are chosen by name and paired by keys", async () => {
  const { user } = await openByKeys("cylinder");
  const { page } = user;
  await tabTo(user, /^Add cylinder$/, farthestTab);
  await user.press("Enter");
  await page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 1 && window.meshgraft.editor.graft.loops.value.size === 2);
  const part = await page.evaluate(() => window.meshgraft.editor.graft.parts.value[0]!.name);
  await user.rests();
  await tabTo(user, /^Pair loops by name$/, farthestTab);
  await user.press("Enter");
  await tabTo(user, new RegExp(`^Loop of ${part}$`));
  await user.press("ArrowDown");
  await whenTold(user, new RegExp(`^${part}, loop 2: .* vertices, .* around, centre at `));
  expect(await page.evaluate(() => window.meshgraft.editor.graft.hovered.value?.loop)).toBe(1);
  await user.rests();
  await user.screenshot(`keys-pairing-${theme}`);
  await tabTo(user, /^Pair$/);
  await user.press("Enter");
  await grafted(user);
  await whenTold(user, new RegExp(`^Loop 2 of ${part} and loop 1 of cylinder are paired`));
  expect(await page.evaluate(() => window.meshgraft.editor.graft.keptPairs.value)).toMatchObject([{ sourceLoop: 1, targetLoop: 0 }]);
  await user.rests();
  await user.screenshot(`keys-paired-${theme}`);
  expect(await pointerEvents(user)).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("a plane is placed, moved and tilted by keys, and cuts", async () => {
  const { user } = await openByKeys("bar");
  const { page } = user;
  const plane = () => page.evaluate(() => window.meshgraft.editor.graft.cutPlane.value?.plane);
  await tabTo(user, /^Off$/, farthestTab);
  await user.press("ArrowRight");
  await whenTold(user, /^The plane cuts bar across Z, through its middle/);
  await tabTo(user, /^Across X$/, farthestTab);
  await user.press("Enter");
  await whenTold(user, /^The plane cuts bar across X/);
  await tabTo(user, /^Across Z$/);
  await user.press("Enter");
  const middle = (await plane())!;
  await tabTo(user, /^Offset$/);
  await user.press("PageUp");
  const raised = (await plane())!;
  expect(raised.point[2]).toBeGreaterThan(middle.point[2]);
  await user.press("Tab"); // the number beside the slider
  await page.keyboard.type("0.5");
  await user.press("Enter");
  expect((await plane())!.point[2]).toBeCloseTo(middle.point[2] + 0.5);
  await tabTo(user, /^Tilt to X$/);
  for (let k = 0; k < 20; ++k) await user.press("ArrowRight");
  await page.waitForFunction(() => (window.meshgraft.editor.graft.cutPlane.value?.plane.normal[0] ?? 0) > 0.34);
  await user.rests();
  await user.screenshot(`keys-plane-${theme}`);
  await tabTo(user, /^Keep red side$/);
  await user.press("Enter");
  await user.settle();
  const steps = await page.evaluate(() => window.meshgraft.editor.state.value?.steps);
  expect(steps![0]).toMatchObject({ kind: "cut", fields: { keep: "below" } });
  const normal = (steps![0]!.fields as { plane: { normal: number[] } }).plane.normal;
  expect(Math.atan2(normal[0]!, normal[2]!)).toBeCloseTo((20 * Math.PI) / 180, 6);
  await whenTold(user, /^Cut\./);
  expect(await pointerEvents(user)).toBe(0);
  expect(user.complaints).toEqual([]);
});
