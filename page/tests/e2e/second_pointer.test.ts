import type { CDPSession } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, type Point, type User } from "./harness";
import { aimAt, farthest, gripOf, openFresh, poseOf, sampled, selectedIn } from "./grips";

let harness: EditorHarness;
let touches: CDPSession;
beforeAll(async () => {
  harness = await EditorHarness.open();
  const { page } = harness.user;
  touches = await page.context().newCDPSession(page);
  await touches.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 2 });
});
afterAll(() => harness.close());

/** Puts these fingers on the screen, moves them there, or lifts these. The first one has the number 1. */
async function touch(type: "touchStart" | "touchMove" | "touchEnd", fingers: Readonly<Record<number, Point>>): Promise<void> {
  const touchPoints = Object.entries(fingers).map(([id, [x, y]]) => ({ x, y, id: Number(id) }));
  await touches.send("Input.dispatchTouchEvent", { type, touchPoints });
}

/** Returns what the view shows: the camera, and the scale of the page. */
function viewOf(user: User): Promise<number[]> {
  return user.page.evaluate(() => {
    const { navigation } = window.meshgraft.viewport;
    const { position, quaternion } = navigation.perspective;
    return [...position.toArray(), ...quaternion.toArray(), navigation.distance, devicePixelRatio, visualViewport?.scale ?? 1];
  });
}

/** Opens the octopus with a handle at the tip of an arm. */
async function openHeld(): Promise<User> {
  const { user } = harness;
  await openFresh(harness, "octopus", 60);
  const at = await aimAt(user, farthest(sampled(harness, "octopus", 60), [1, -0.3, 0]));
  await user.press("h");
  await user.stroke([at, [at[0] - 6, at[1] + 4]]);
  await user.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await user.press("q");
  await user.rests();
  return user;
}

const beside = (at: Point, dx: number, dy: number): Point => [at[0] + dx, at[1] + dy];

test("a second finger neither moves the camera nor ends a drag of the gizmo", async () => {
  const user = await openHeld();
  const before = await viewOf(user);
  const ball = await gripOf(user, "ball");
  const second: Point = [400, 250];
  await touch("touchStart", { 1: ball });
  await touch("touchMove", { 1: beside(ball, 10, -30) });
  await touch("touchStart", { 2: second });
  await touch("touchMove", { 2: beside(second, -80, 60) });
  await touch("touchMove", { 1: beside(ball, 15, -60), 2: beside(second, -120, 90) });
  await touch("touchEnd", { 2: beside(second, -120, 90) });
  await touch("touchMove", { 1: beside(ball, 20, -90) });
  await touch("touchEnd", { 1: beside(ball, 20, -90) });
  await user.settle();
  expect(await viewOf(user)).toEqual(before);
  const moved = (await poseOf(user))?.translate ?? [NaN];

  await user.press("Control+z");
  await user.settle();
  await user.stroke([ball, beside(ball, 20, -90)]);
  await user.settle();
  (await poseOf(user))?.translate?.forEach((x, k) => expect(moved[k]).toBeCloseTo(x, 4));
  expect(user.complaints).toEqual([]);
});

test("the wheel and a pinch on the trackpad leave the camera during a drag", async () => {
  const user = await openHeld();
  const { page } = user;
  const before = await viewOf(user);
  const ball = await gripOf(user, "ball");
  await page.mouse.move(...ball);
  await page.mouse.down();
  await page.mouse.move(...beside(ball, 20, -90), { steps: 5 });
  for (const isPinch of [true, false]) {
    if (isPinch) await page.keyboard.down("Control");
    for (const by of [-60, 90]) await user.wheel(by);
    if (isPinch) await page.keyboard.up("Control");
  }
  await page.mouse.move(...beside(ball, 21, -90));
  expect(await viewOf(user)).toEqual(before);
  await page.mouse.up();
  await user.settle();
  expect((await poseOf(user))?.translate).toBeDefined();
  await user.wheel(-60);
  await user.rests();
  expect(await viewOf(user)).not.toEqual(before);
  expect(user.complaints).toEqual([]);
});

test("a second finger does not end a stroke of the brush, but makes a click a pinch", async () => {
  const { user } = harness;
  await openFresh(harness, "bust");
  const rest = sampled(harness, "bust");
  const nose = await aimAt(user, farthest(rest, [0, -1, 0.2]));
  const before = await viewOf(user);
  await user.press("b");
  await touch("touchStart", { 1: nose });
  await touch("touchStart", { 2: beside(nose, 60, 40) });
  await touch("touchMove", { 2: beside(nose, 160, 90) });
  await touch("touchEnd", { 2: beside(nose, 160, 90) });
  await touch("touchMove", { 1: beside(nose, 12, 0) });
  await touch("touchEnd", { 1: beside(nose, 12, 0) });
  await user.settle();
  expect(await viewOf(user)).toEqual(before);
  const painted = await selectedIn(user);
  expect(painted.length).toBeGreaterThan(0);

  await user.press("c");
  await touch("touchStart", { 1: nose });
  await touch("touchStart", { 2: beside(nose, 60, 40) });
  await touch("touchMove", { 2: beside(nose, 120, 80) });
  await touch("touchEnd", { 2: beside(nose, 120, 80) });
  await touch("touchEnd", { 1: nose });
  await user.rests();
  expect(await viewOf(user)).not.toEqual(before);
  expect(await selectedIn(user)).toEqual(painted);
  expect(user.complaints).toEqual([]);
});
