import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";
import { EditorHarness, type User } from "./harness";
import { aimAt, centreOf, distance, farthest, gripOf, openFresh, positionOf, poseOf, sampled } from "./grips";
import { sizeOf, verticesOf } from "./grips";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());
beforeEach(() => (harness.user.actions = 0));

/** Returns the vertices that moved by more than a thousandth of the largest movement. */
function moved(before: Float64Array, after: Float64Array): Set<number> {
  const far = Array.from({ length: before.length / 3 }, (_, v) => distance(positionOf(before, v), positionOf(after, v)));
  const most = Math.max(...far);
  return new Set(far.flatMap((by, v) => (by > 1e-3 * most ? [v] : [])));
}

async function held(user: User): Promise<void> {
  await user.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
}

test("makes a nose bigger in three actions", async () => {
  const { user } = harness;
  await openFresh(harness, "head");
  const rest = sampled(harness, "head");
  await user.page.keyboard.press("Numpad1");
  await user.rests();
  const nose = await user.screenOf(farthest(rest, [0, -1, 0]));

  await user.press("h");
  await user.stroke([nose, [nose[0] + 8, nose[1] + 12]]);
  const knob = await gripOf(user, "knob"); // while the engine still sets up
  await user.stroke([knob, [knob[0] + 50, knob[1] - 50]]);
  expect(user.actions).toBeLessThanOrEqual(3);

  await user.settle();
  await user.screenshot("tools-nose");
  const pose = await poseOf(user);
  const scale = typeof pose?.scale === "number" ? pose.scale : (pose?.scale?.[0] ?? NaN);
  expect(scale).toBeGreaterThan(1.3);
  const vertices = await verticesOf(user);
  const saved = await harness.savedPositions();
  expect(vertices.length).toBeGreaterThan(5);
  expect(sizeOf(saved, vertices) / sizeOf(rest, vertices)).toBeCloseTo(scale, 2);
  expect(distance(centreOf(saved, vertices), centreOf(rest, vertices))).toBeLessThan(sizeOf(rest, vertices));
  expect(moved(rest, saved).size).toBeLessThan(rest.length / 6); // only the surrounding faces
  expect(user.complaints).toEqual([]);
});

test("bends an arm in four actions, and takes it back", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  const rest = sampled(harness, "octopus", 60);
  const tip = farthest(rest, [1, -0.3, 0]);
  const at = await aimAt(user, tip);

  await user.press("h");
  await user.stroke([at, [at[0] - 6, at[1] + 4]]);
  await held(user);
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, [ball[0] + 20, ball[1] - 90]]);
  const ring = await gripOf(user, "view-ring");
  await user.stroke([ring, [ring[0] + 40, ring[1] + 30]]);
  expect(user.actions).toBeLessThanOrEqual(4);

  await user.settle();
  await user.screenshot("tools-arm");
  const pose = await poseOf(user);
  expect(pose?.translate).toBeDefined();
  expect(Math.abs(pose?.rotate?.angle_deg ?? 0)).toBeGreaterThan(5);
  const bent = await harness.savedPositions();
  const vertices = await verticesOf(user);
  const [dx, dy, dz] = pose?.translate ?? [0, 0, 0];
  const goal = centreOf(rest, vertices).map((part, k) => part + ([dx, dy, dz][k] as number));
  expect(distance(centreOf(bent, vertices), goal)).toBeLessThan(0.5 * sizeOf(rest, vertices));
  expect(sizeOf(bent, vertices)).toBeCloseTo(sizeOf(rest, vertices), 4);

  for (const _ of ["turn", "move", "paint"]) await user.press("Control+z");
  await user.settle();
  expect(await user.page.evaluate(() => window.meshgraft.editor.state.value?.handles.length)).toBe(0);
  const strayed = await user.page.evaluate(() => {
    const surface = window.meshgraft.viewport.main;
    return surface?.positions.reduce((most, x, i) => Math.max(most, Math.abs(x - (surface.rest[i] ?? NaN))), 0);
  });
  expect(strayed).toBe(0);
});

test("turns twice round, by axis and number; escape leaves it as it was", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  const rest = sampled(harness, "octopus", 60);
  const at = await user.screenOf(farthest(rest, [0, -0.2, 1]));
  await user.press("h");
  await user.stroke([[at[0], at[1] + 14], [at[0] + 10, at[1] + 26]]);
  await held(user);
  await user.settle();

  for (const key of ["r", "z", "7", "2", "0", "Enter"]) await user.press(key);
  await user.settle();
  expect((await poseOf(user))?.rotate).toEqual({ axis: [0, 0, 1], angle_deg: 720 });
  await user.press("r");
  await user.press("z");
  for (const key of ["9", "0", "Enter"]) await user.press(key);
  await user.settle();
  expect((await poseOf(user))?.rotate?.angle_deg).toBe(810);

  const before = await poseOf(user);
  await user.press("g");
  await user.page.mouse.move(700, 300, { steps: 5 });
  await user.screenshot("tools-move-by-key");
  await user.press("Escape");
  await user.settle();
  expect(await poseOf(user)).toEqual(before);

  const vertices = await verticesOf(user);
  const saved = await harness.savedPositions();
  // A turn of 810° leaves the handle's vertices where one of 90° does.
  const [px, py] = await user.page.evaluate(
    () => window.meshgraft.editor.state.value?.handles[0]?.pivot ?? ([0, 0, 0] as const),
  );
  for (const v of vertices.slice(0, 50)) {
    const [x, y, z] = positionOf(rest, v);
    const goal = [px - (y - py), py + (x - px), z];
    expect(distance(positionOf(saved, v), goal)).toBeLessThan(1e-5);
  }
});

test("snaps, scales one axis, and moves the pivot without moving the handle", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  const rest = sampled(harness, "octopus", 60);
  const at = await user.screenOf(farthest(rest, [0, -0.2, 1]));
  await user.press("h");
  await user.stroke([[at[0], at[1] + 14], [at[0] + 10, at[1] + 26]]);
  await held(user);
  await user.settle();

  await user.press("Shift+S");
  const arrow = await gripOf(user, "arrow-z");
  await user.stroke([arrow, [arrow[0] + 3, arrow[1] - 47]]);
  await user.press("Shift+S");
  await user.settle();
  const [x, y, z] = (await poseOf(user))?.translate ?? [1, 1, 0];
  const diagonal = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.diagonal ?? 0);
  expect([x, y]).toEqual([0, 0]);
  expect((100 * z) / diagonal).toBeGreaterThan(2);
  expect((100 * z) / diagonal).toBeCloseTo(Math.round((100 * z) / diagonal), 9);

  const box = await gripOf(user, "box-x");
  await user.stroke([box, [box[0] + 30, box[1] - 5]]);
  await user.settle();
  const scale = (await poseOf(user))?.scale;
  expect(scale).toEqual([expect.any(Number), 1, 1]);
  expect((scale as number[])[0]).toBeGreaterThan(1.1);

  const still = await harness.savedPositions();
  const ball = await gripOf(user, "ball");
  await user.press("d");
  await user.screenshot("tools-pivot");
  await user.stroke([ball, [ball[0] - 40, ball[1] + 60]]);
  await user.press("d");
  await user.settle();
  expect((await poseOf(user))?.pivot).toBeDefined();
  const after = await harness.savedPositions();
  for (const v of await verticesOf(user)) expect(distance(positionOf(after, v), positionOf(still, v))).toBeLessThan(1e-6);
  expect(user.complaints).toEqual([]);
});

test("drags the reach of a handle", async () => {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  const rest = sampled(harness, "octopus", 60);
  const at = await user.screenOf(farthest(rest, [0, -0.2, 1]));
  await user.press("h");
  await user.stroke([[at[0], at[1] + 14], [at[0] + 10, at[1] + 26]]);
  await held(user);
  await user.settle();
  const reach = () => user.page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.reach ?? 0);
  const region = () => user.page.evaluate(() => window.meshgraft.viewport.main?.region.length ?? 0);
  const [before, inside] = [await reach(), await region()];
  const knob = await user.page.evaluate(() => {
    const box = document.querySelector(".reach-knob")?.getBoundingClientRect() ?? new DOMRect();
    return [box.x + box.width / 2, box.y + box.height / 2] as const;
  });
  const { page } = user;
  await page.mouse.move(...knob);
  await page.mouse.down();
  await page.mouse.move(knob[0] + 40, knob[1] + 40, { steps: 6 });
  await page.waitForFunction(() => window.meshgraft.editor.tools.reachFor.value !== null);
  await user.screenshot("tools-reach-dragged");
  await page.mouse.up();
  await user.page.waitForFunction((was) => window.meshgraft.editor.state.value?.handles[0]?.reach !== was, before);
  await user.settle();
  await user.screenshot("tools-reach");
  expect(await reach()).toBeGreaterThan(1.2 * before);
  expect(await region()).toBeGreaterThan(inside);
  expect(await page.evaluate(() => window.meshgraft.editor.tools.reachFor.value)).toBeNull();

  // The vertices highlighted during the choice are those that the engine then moves.
  const lit = await page.evaluate(() => {
    const { editor, viewport } = window.meshgraft;
    const handle = editor.state.value?.handles[0];
    editor.tools.reachFor.value = { handle: handle?.name ?? "", reach: handle?.reach ?? 0 };
    const shown = new Set<number>();
    viewport.scene.traverse((object) => {
      const mesh = object as typeof object & { isMesh?: boolean; geometry?: { index: { array: Uint32Array } | null } };
      if (mesh.isMesh === true && mesh.visible && mesh.parent === viewport.scene && mesh.renderOrder === 0)
        mesh.geometry?.index?.array.forEach((v) => shown.add(v));
    });
    editor.tools.reachFor.value = null;
    const region = new Set(viewport.main?.region);
    return { shown: shown.size, outside: [...shown].filter((v) => !region.has(v)).length };
  });
  expect(lit.shown).toBeGreaterThan(0.8 * (await region()));
  expect(lit.outside).toBe(0);
});
