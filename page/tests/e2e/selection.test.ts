import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, type Point, type User } from "./harness";
import { distance, farthest, openFresh, positionOf, sampled, selectedIn } from "./grips";

let harness: EditorHarness;
let rest: Float64Array;
let top: Point; // a little below the top of the head
beforeAll(async () => {
  harness = await EditorHarness.open();
  rest = sampled(harness, "octopus", 60);
  await openFresh(harness, "octopus", 60);
  const [x, y] = await harness.user.screenOf(farthest(rest, [0, -0.2, 1]));
  top = [x, y + 30];
});
afterAll(() => harness.close());

async function selectedAfter(user: User, act: () => Promise<void>): Promise<number[]> {
  await act();
  await user.settle();
  const selected = await selectedIn(user);
  const count = await user.page.evaluate(() => window.meshgraft.editor.selected.value);
  expect(selected.length).toBe(count); // the view shows the engine's selection
  return selected;
}

/** Keeps the page from making pictures, until `releaseFrames`. */
function holdFrames(user: User): Promise<void> {
  return user.page.evaluate(() => {
    const held: FrameRequestCallback[] = [];
    const request = window.requestAnimationFrame;
    window.requestAnimationFrame = (call) => held.push(call);
    Object.assign(window, {
      releaseFrames: () => {
        window.requestAnimationFrame = request;
        for (const call of held) window.requestAnimationFrame(call);
      },
    });
  });
}
function releaseFrames(user: User): Promise<void> {
  return user.page.evaluate(() => (window as unknown as { releaseFrames: () => void }).releaseFrames());
}

test("a brush adds, takes away, and grows by its keys", async () => {
  const { user } = harness;
  await user.press("b");
  const small = await selectedAfter(user, () => user.stroke([top, [top[0] + 20, top[1]]]));
  expect(small.length).toBeGreaterThan(8);
  const spread = Math.max(...small.map((v) => distance(positionOf(rest, v), positionOf(rest, small[0] as number))));
  expect(spread).toBeLessThan(1);

  await user.page.keyboard.down("Control");
  const less = await selectedAfter(user, () => user.stroke([top, [top[0] + 1, top[1]]]));
  await user.page.keyboard.up("Control");
  expect(less.length).toBeLessThan(small.length);
  expect(less.every((v) => small.includes(v))).toBe(true);

  for (let i = 0; i < 5; ++i) await user.press("]");
  const large = await selectedAfter(user, () => user.stroke([top, [top[0] + 20, top[1]]]));
  expect(large.length).toBeGreaterThan(1.5 * small.length);
  await user.page.mouse.move(...top);
  await user.screenshot("tools-brush");
  await user.press("Shift+A");
  expect(await selectedAfter(user, async () => undefined)).toEqual([]);
});

test("a lasso and a box take what is seen, or what lies behind, too", async () => {
  const { user } = harness;
  const around: Point[] = [[-60, -60], [60, -60], [60, 40], [-60, 40]].map(([x = 0, y = 0]) => [top[0] + x, top[1] + y]);
  await user.press("l");
  const seen = await selectedAfter(user, () => user.stroke([...around, around[0] as Point]));
  expect(seen.length).toBeGreaterThan(100);
  await user.press("Shift+A");
  await user.rests(); // the bar of the selection, which lies over the stroke, goes

  await holdFrames(user); // as on a machine that draws slowly: the outline has the same shape
  const late = await selectedAfter(user, () => user.stroke([...around, around[0] as Point]));
  await releaseFrames(user);
  await user.rests();
  expect(late).toEqual(seen);
  await user.press("Shift+A");
  await user.rests();
  await user.press("t");
  await user.press("m");
  const all = await selectedAfter(user, () => user.stroke([around[0] as Point, around[2] as Point]));
  await user.press("t");
  expect(all.length).toBeGreaterThan(1.5 * seen.length);
  const isIn = new Set(all);
  expect(seen.filter((v) => !isIn.has(v)).length).toBeLessThan(0.02 * seen.length);
  await user.screenshot("tools-box");
});

test("connected parts, all, grown, shrunk and inverted", async () => {
  const { user } = harness;
  await user.press("Shift+A");
  await user.rests();
  await user.press("c");
  await user.page.mouse.move(...top);
  await user.page.waitForSelector(".tool-status:not([display])", { state: "attached" });
  expect(await user.page.textContent(".tool-status text")).toMatch(/^Connected/);
  await user.screenshot("tools-connected");
  const part = await selectedAfter(user, () => user.clickAt(top));
  expect(part.length).toBeGreaterThan(1000);
  await user.press("Shift+A");
  await user.rests();

  await user.press("b");
  const brushed = await selectedAfter(user, () => user.stroke([top, [top[0] + 1, top[1]]]));
  const grown = await selectedAfter(user, () => user.press("+"));
  expect(grown.length).toBeGreaterThan(brushed.length);
  const shrunk = await selectedAfter(user, () => user.press("-"));
  expect(brushed.filter((v) => !shrunk.includes(v))).toEqual([]);
  const others = await selectedAfter(user, () => user.press("i"));
  expect(others.length).toBe(rest.length / 3 - shrunk.length);
  expect((await selectedAfter(user, () => user.press("a"))).length).toBe(rest.length / 3);
});

test("a selection becomes the region, and nothing outside of it moves", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  await user.press("p");
  await user.clickAt([top[0] + 3, top[1] + 5]);
  await user.settle();
  await user.press("m");
  await user.press("t");
  const corners: Point[] = [[top[0] - 150, top[1] - 60], [top[0] + 150, top[1] + 90]];
  const inside = new Set(await selectedAfter(user, () => user.stroke(corners)));
  await user.press("t");
  await user.press("Shift+E"); // replaces the region around the handle
  await user.press("Shift+A");
  await user.settle();
  for (const key of ["g", "z", ".", "3", "Enter"]) await user.press(key);
  await user.settle();
  await user.screenshot("tools-region");
  const saved = await harness.savedPositions();
  const far = Array.from({ length: rest.length / 3 }, (_, v) => distance(positionOf(rest, v), positionOf(saved, v)));
  expect(Math.max(...far)).toBeGreaterThan(0.29);
  far.forEach((by, v) => by > 0 && expect(inside.has(v)).toBe(true));
});

test("a curve handle along clicked points, closed at its first", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  await user.press("u");
  await user.clickAt([top[0] - 40, top[1] + 30]);
  await user.clickAt([top[0] + 30, top[1] + 40]);
  await user.page.mouse.move(top[0] + 10, top[1] + 80);
  await user.rests();
  await user.screenshot("tools-curve");
  await user.press("Enter");
  await user.settle();
  const first = await user.page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]);
  expect(first?.shape).toBe("curve");
  expect(first?.closed).toBe(false);
  expect(first?.vertices).toBeGreaterThan(5);

  const corners: Point[] = [[-40, 90], [40, 90], [5, 130]].map(([x = 0, y = 0]) => [top[0] + x, top[1] + y]);
  await user.press("Escape"); // lets go of the handle
  await user.press("u");
  for (const corner of corners) await user.clickAt(corner);
  await user.clickAt(corners[0] as Point);
  await user.settle();
  const second = await user.page.evaluate(() => window.meshgraft.editor.state.value?.handles[1]);
  expect(second?.closed).toBe(true);
  expect(user.complaints).toEqual([]);
});

test("the boundary of a hole, from near it", async () => {
  const { user } = harness;
  await openFresh(harness, "head");
  const positions = sampled(harness, "head");
  await user.press("o");
  const [x, y] = await user.screenOf(farthest(positions, [0, -0.1, -1]));
  await user.page.mouse.move(x, y - 5, { steps: 3 });
  await user.rests();
  await user.screenshot("tools-loop");
  const boundary = await selectedAfter(user, () => user.clickAt([x, y - 5]));
  expect(boundary.length).toBeGreaterThan(10);
  const heights = boundary.map((v) => positionOf(positions, v)[2]);
  expect(Math.max(...heights) - Math.min(...heights)).toBeLessThan(0.05);
});
