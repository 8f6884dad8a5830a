import { afterAll, beforeAll, expect, test } from "vitest";
import { Stage, type Person, type Point } from "./harness";
import { distance, farthest, openFresh, positionOf, sampled, selectedIn } from "./grips";

let stage: Stage;
let rest: Float64Array;
let top: Point; // a little below the top of the head
beforeAll(async () => {
  stage = await Stage.open();
  rest = sampled(stage, "octopus");
  await openFresh(stage, "octopus");
  const [x, y] = await stage.person.screenOf(farthest(rest, [0, -0.2, 1]));
  top = [x, y + 30];
});
afterAll(() => stage.close());

async function selectedAfter(person: Person, act: () => Promise<void>): Promise<number[]> {
  await act();
  await person.settle();
  const selected = await selectedIn(person);
  const count = await person.page.evaluate(() => window.meshgraft.editor.selected.value);
  expect(selected.length).toBe(count); // the view shows the engine's selection
  return selected;
}

test("a brush adds, takes away, and grows by its keys", async () => {
  const { person } = stage;
  await person.press("b");
  const small = await selectedAfter(person, () => person.stroke([top, [top[0] + 20, top[1]]]));
  expect(small.length).toBeGreaterThan(20);
  const spread = Math.max(...small.map((v) => distance(positionOf(rest, v), positionOf(rest, small[0] as number))));
  expect(spread).toBeLessThan(1);

  await person.page.keyboard.down("Control");
  const less = await selectedAfter(person, () => person.stroke([top, [top[0] + 1, top[1]]]));
  await person.page.keyboard.up("Control");
  expect(less.length).toBeLessThan(small.length);
  expect(less.every((v) => small.includes(v))).toBe(true);

  for (let i = 0; i < 5; ++i) await person.press("]");
  const large = await selectedAfter(person, () => person.stroke([top, [top[0] + 20, top[1]]]));
  expect(large.length).toBeGreaterThan(1.5 * small.length);
  await person.page.mouse.move(...top);
  await person.screenshot("tools-brush");
  await person.press("Shift+A");
  expect(await selectedAfter(person, async () => undefined)).toEqual([]);
});

test("a lasso and a box take what is seen, or what lies behind, too", async () => {
  const { person } = stage;
  const around: Point[] = [[-60, -60], [60, -60], [60, 40], [-60, 40]].map(([x = 0, y = 0]) => [top[0] + x, top[1] + y]);
  await person.press("l");
  const seen = await selectedAfter(person, () => person.stroke([...around, around[0] as Point]));
  expect(seen.length).toBeGreaterThan(100);
  await person.press("Shift+A");
  await person.press("t");
  await person.press("m");
  const all = await selectedAfter(person, () => person.stroke([around[0] as Point, around[2] as Point]));
  await person.press("t");
  expect(all.length).toBeGreaterThan(1.5 * seen.length);
  const isIn = new Set(all);
  expect(seen.filter((v) => !isIn.has(v)).length).toBeLessThan(0.02 * seen.length);
  await person.screenshot("tools-box");
});

test("connected parts, all, grown, shrunk and inverted", async () => {
  const { person } = stage;
  await person.press("Shift+A");
  await person.press("c");
  await person.page.mouse.move(...top);
  await person.page.waitForSelector(".tool-status:not([display])", { state: "attached" });
  expect(await person.page.textContent(".tool-status text")).toMatch(/^Connected part/);
  await person.screenshot("tools-connected");
  const part = await selectedAfter(person, () => person.clickAt(top));
  expect(part.length).toBeGreaterThan(1000);
  await person.press("Shift+A");

  await person.press("b");
  const brushed = await selectedAfter(person, () => person.stroke([top, [top[0] + 1, top[1]]]));
  const grown = await selectedAfter(person, () => person.press("+"));
  expect(grown.length).toBeGreaterThan(brushed.length);
  const shrunk = await selectedAfter(person, () => person.press("-"));
  expect(brushed.filter((v) => !shrunk.includes(v))).toEqual([]);
  const others = await selectedAfter(person, () => person.press("i"));
  expect(others.length).toBe(rest.length / 3 - shrunk.length);
  expect((await selectedAfter(person, () => person.press("a"))).length).toBe(rest.length / 3);
});

test("a selection becomes the region, and nothing outside of it moves", async () => {
  const { person } = stage;
  await openFresh(stage, "octopus");
  await person.press("p");
  await person.clickAt([top[0] + 3, top[1] + 5]);
  await person.settle();
  await person.press("m");
  await person.press("t");
  const corners: Point[] = [[top[0] - 150, top[1] - 60], [top[0] + 150, top[1] + 90]];
  const inside = new Set(await selectedAfter(person, () => person.stroke(corners)));
  await person.press("t");
  await person.press("Shift+E"); // replaces the region around the handle
  await person.press("Shift+A");
  await person.settle();
  for (const key of ["g", "z", ".", "3", "Enter"]) await person.press(key);
  await person.settle();
  await person.screenshot("tools-region");
  const saved = await stage.savedPositions();
  const far = Array.from({ length: rest.length / 3 }, (_, v) => distance(positionOf(rest, v), positionOf(saved, v)));
  expect(Math.max(...far)).toBeGreaterThan(0.29);
  far.forEach((by, v) => by > 0 && expect(inside.has(v)).toBe(true));
});

test("a curve handle along clicked points, closed at its first", async () => {
  const { person } = stage;
  await openFresh(stage, "octopus");
  await person.press("u");
  await person.clickAt([top[0] - 40, top[1] + 30]);
  await person.clickAt([top[0] + 30, top[1] + 40]);
  await person.page.mouse.move(top[0] + 10, top[1] + 80);
  await person.rests();
  await person.screenshot("tools-curve");
  await person.press("Enter");
  await person.settle();
  const first = await person.page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]);
  expect(first?.shape).toBe("curve");
  expect(first?.closed).toBe(false);
  expect(first?.vertices).toBeGreaterThan(5);

  const corners: Point[] = [[-40, 90], [40, 90], [5, 130]].map(([x = 0, y = 0]) => [top[0] + x, top[1] + y]);
  await person.press("Escape"); // lets go of the handle
  await person.press("u");
  for (const corner of corners) await person.clickAt(corner);
  await person.clickAt(corners[0] as Point);
  await person.settle();
  const second = await person.page.evaluate(() => window.meshgraft.editor.state.value?.handles[1]);
  expect(second?.closed).toBe(true);
  expect(person.complaints).toEqual([]);
});

test("the rim of a hole, from near it", async () => {
  const { person } = stage;
  await openFresh(stage, "head");
  const positions = sampled(stage, "head");
  await person.press("o");
  const [x, y] = await person.screenOf(farthest(positions, [0, -0.1, -1]));
  await person.page.mouse.move(x, y - 5, { steps: 3 });
  await person.rests();
  await person.screenshot("tools-loop");
  const rim = await selectedAfter(person, () => person.clickAt([x, y - 5]));
  expect(rim.length).toBeGreaterThan(10);
  const heights = rim.map((v) => positionOf(positions, v)[2]);
  expect(Math.max(...heights) - Math.min(...heights)).toBeLessThan(0.05);
});
