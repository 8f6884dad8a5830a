// Drives the gestures of the view and of the gizmo, and the fields of the panel Method, as a person does.
import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";
import type { Vector } from "../../src/protocol";
import { aimAt, centreOf, distance, farthest, gripOf, openFresh, poseOf, sampled, selectedIn, verticesOf } from "./grips";
import { EditorHarness, type Point, type User } from "./harness";

let harness: EditorHarness;
let user: User;
beforeAll(async () => {
  harness = await EditorHarness.open();
  user = harness.user;
});
afterAll(() => harness.close());
beforeEach(async () => {
  await openFresh(harness, "octopus", 60);
  await user.press("Escape");
  await user.press("q");
  await user.press("Home");
  await user.rests();
});

interface Viewpoint {
  position: Vector;
  target: Vector;
  ahead: Vector;
  distance: number;
}

function viewpoint(): Promise<Viewpoint> {
  return user.page.evaluate(() => {
    const { navigation, camera } = window.meshgraft.viewport;
    return {
      position: camera.position.toArray() as Vector,
      target: navigation.target.toArray() as Vector,
      ahead: camera.getWorldDirection(navigation.target.clone()).toArray() as Vector,
      distance: navigation.distance,
    };
  });
}

const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: readonly number[], b: readonly number[]) => a.reduce((sum, x, k) => sum + x * (b[k] as number), 0);
const beside = (at: Point, dx: number, dy: number): Point => [at[0] + dx, at[1] + dy];

/** Returns a point of the view that is beside the model. */
function offModel(): Promise<Point> {
  return user.page.evaluate(() => {
    const { viewport } = window.meshgraft;
    const box = viewport.canvas.getBoundingClientRect();
    for (const [u, v] of [[0.1, 0.9], [0.9, 0.9], [0.1, 0.5], [0.85, 0.6]] as const) {
      const [x, y] = [box.left + u * box.width, box.top + v * box.height];
      if (viewport.pick(x, y) === undefined) return [x, y] as const;
    }
    throw new Error("the model fills the view");
  });
}

/** Holds the tip of an arm. */
async function hold(): Promise<void> {
  await user.rests();
  const at = await aimAt(user, farthest(sampled(harness, "octopus", 60), [1, -0.3, 0]));
  await user.press("h");
  await user.stroke([at, beside(at, -6, 4)]);
  await user.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await user.press("q");
  await user.rests();
}

test("a drag beside the model orbits about what is framed, at the same distance", async () => {
  const before = await viewpoint();
  const at = await offModel();
  await user.stroke([at, beside(at, 80, -20)]);
  await user.rests();
  const after = await viewpoint();
  expect(after.target).toEqual(before.target);
  expect(after.distance).toBeCloseTo(before.distance, 9);
  expect(dot(after.ahead, before.ahead)).toBeLessThan(0.95);
  await user.stroke([at, beside(at, -80, 20)], { button: "middle" });
  await user.rests();
  expect(dot((await viewpoint()).ahead, before.ahead)).toBeCloseTo(1, 6); // back again
});

test("a right drag pans: the model follows the pointer", async () => {
  const tip = farthest(sampled(harness, "octopus", 60), [0, 0, 1]);
  const [before, was] = [await viewpoint(), await user.screenOf(tip)];
  const at = await offModel();
  await user.stroke([at, beside(at, 60, -40)], { button: "right" });
  await user.rests();
  const [after, is] = [await viewpoint(), await user.screenOf(tip)];
  expect(after.ahead).toEqual(before.ahead);
  expect(dot(minus(after.target, before.target), before.ahead)).toBeCloseTo(0, 6); // in the plane of the screen
  expect(is[0] - was[0]).toBeCloseTo(60, -1);
  expect(is[1] - was[1]).toBeCloseTo(-40, -1);
});

test("the wheel zooms towards the pointer, which stays where it is", async () => {
  const tip = farthest(sampled(harness, "octopus", 60), [1, -0.3, 0]);
  const [before, was] = [await viewpoint(), await user.screenOf(tip)];
  await user.page.mouse.move(...(await aimAt(user, tip)));
  await user.wheel(-240);
  await user.rests();
  const [after, is] = [await viewpoint(), await user.screenOf(tip)];
  expect(after.distance).toBeLessThan(0.9 * before.distance);
  expect(Math.hypot(is[0] - was[0], is[1] - was[1])).toBeLessThan(12);
});

test("the keys of views look along the axes, F frames the handle and Home everything", async () => {
  const along: Record<string, Vector> = { 1: [0, 1, 0], 2: [0, -1, 0], 3: [-1, 0, 0], 4: [1, 0, 0], 7: [0, 0, -1], 8: [0, 0, 1] };
  for (const [key, direction] of Object.entries(along)) {
    await user.press(key);
    await user.rests();
    expect(dot((await viewpoint()).ahead, direction), key).toBeCloseTo(1, 5);
  }
  await user.press("1");
  await hold();
  await user.press("Home");
  await user.rests();
  const all = await viewpoint();
  await user.press("f");
  await user.rests();
  expect((await viewpoint()).distance).toBeLessThan(0.5 * all.distance);
  await user.press("Home");
  await user.rests();
  expect((await viewpoint()).distance).toBeCloseTo(all.distance, 1);
});

test("a double click frames what is below it", async () => {
  const before = await viewpoint();
  const tip = farthest(sampled(harness, "octopus", 60), [1, -0.3, 0]);
  await user.page.mouse.dblclick(...(await aimAt(user, tip)));
  await user.rests();
  const after = await viewpoint();
  expect(after.distance).toBeLessThan(0.8 * before.distance);
  const at = await user.screenOf(tip);
  const { x, y } = await user.page.evaluate(() => {
    const box = window.meshgraft.viewport.canvas.getBoundingClientRect();
    return { x: box.left + box.width / 2, y: box.top + box.height / 2 };
  });
  expect(Math.hypot(at[0] - x, at[1] - y)).toBeLessThan(80);
});

test("a click on the view cube looks from there, a drag of it orbits", async () => {
  await user.press("1");
  await user.rests();
  const cube = (await user.page.locator(".view-cube").boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
  const middle: Point = [cube.x + cube.width / 2, cube.y + cube.height / 2];
  await user.clickAt(beside(middle, 0, -24)); // the edge between front and top
  await user.rests();
  expect(dot((await viewpoint()).ahead, [0, Math.SQRT1_2, -Math.SQRT1_2])).toBeCloseTo(1, 4);
  const before = await viewpoint();
  await user.stroke([middle, beside(middle, 30, 0)]);
  await user.rests();
  const after = await viewpoint();
  expect(dot(after.ahead, before.ahead)).toBeLessThan(0.99);
  expect(after.ahead[2]).toBeCloseTo(before.ahead[2], 6); // about the vertical
});

test("flood fill selects up to a crease, and its angle decides where that is", async () => {
  await openFresh(harness, "bar", 20);
  await user.press("Home");
  await user.rests();
  const rest = sampled(harness, "bar", 20);
  const inFront = [...Array(rest.length / 3).keys()].filter((v) => {
    const [x = 0, y = 0, z = 0] = rest.slice(3 * v, 3 * v + 3);
    return y < -0.49 && Math.abs(x) < 0.15 && Math.abs(z) < 0.3;
  });
  const side = await aimAt(user, inFront[0] ?? 0);
  const angle = user.page.getByRole("toolbar", { name: "Tool options" }).getByRole("textbox", { name: "Crease angle" });
  const flooded = async (deg: string) => {
    await user.press("w");
    await angle.fill(deg);
    await angle.press("Enter");
    await user.press("Escape");
    await user.press("w");
    await user.page.mouse.move(...beside(side, 2, 2));
    await user.clickAt(side);
    await user.settle();
    const selected = await selectedIn(user);
    await user.press("Alt+a");
    await user.settle();
    return selected;
  };
  const face = await flooded("30");
  const heights = face.map((v) => rest[3 * v + 1] as number);
  expect(face.length).toBeGreaterThan(20);
  expect(Math.max(...heights) - Math.min(...heights)).toBeLessThan(0.2); // one side of the bar
  const all = await flooded("120");
  expect(all.length).toBe(rest.length / 3);
});

test("the mesh before is shown while the key or the button is held", async () => {
  await hold();
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, beside(ball, 10, -60)]);
  await user.settle();
  const isBefore = () => user.page.evaluate(() => window.meshgraft.editor.view.before.value);
  await user.page.keyboard.down("\\");
  expect(await isBefore()).toBe(true);
  await user.rests();
  expect(await user.page.locator(".gizmo:not([display]) > [data-part]").count()).toBe(0);
  await user.screenshot("gestures-before");
  await user.page.keyboard.up("\\");
  expect(await isBefore()).toBe(false);
  const button = user.page.getByRole("button", { name: "Before and after" });
  const box = (await button.boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
  await user.page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await user.page.mouse.down();
  expect(await isBefore()).toBe(true);
  await user.page.mouse.up();
  expect(await isBefore()).toBe(false);
});

/** Returns a point of a ring that is away from all other grips. */
async function freeOfRing(axis: string): Promise<Point> {
  await gripOf(user, `ring-${axis}`); // waits until it is drawn
  return user.page.evaluate((id) => {
    const pointsOf = (part: Element): DOMPoint[] => {
      const line = part.querySelector<SVGPathElement>(".line");
      const map = line?.getScreenCTM();
      if (line === null || map === null || map === undefined) return [];
      const length = line.getTotalLength();
      return Array.from({ length: 41 }, (_, k) => line.getPointAtLength((k / 40) * length).matrixTransform(map));
    };
    const parts = [...document.querySelectorAll(".gizmo [data-part]:not([display])")];
    const own = parts.find((part) => part.getAttribute("data-part") === id);
    const others = parts.filter((part) => part !== own).flatMap(pointsOf);
    const room = ({ x, y }: DOMPoint) => Math.min(...others.map((other) => Math.hypot(other.x - x, other.y - y)));
    const [best] = (own === undefined ? [] : pointsOf(own)).sort((a, b) => room(b) - room(a));
    if (best === undefined) throw new Error(`no ${id}`);
    return [best.x, best.y] as const;
  }, `ring-${axis}`);
}

test("a square moves the handle in its plane, a ring turns it about its axis", async () => {
  await hold();
  for (const [axis, k] of [["x", 0], ["y", 1], ["z", 2]] as const) {
    const square = user.page.locator(`.gizmo [data-part="square-${axis}"]:not([display])`);
    if ((await square.count()) === 0) continue; // seen edge-on
    const at = await gripOf(user, `square-${axis}`);
    await user.stroke([at, beside(at, 25, -15)]);
    await user.settle();
    const moved = (await poseOf(user))?.translate ?? [NaN, NaN, NaN];
    expect(moved[k], axis).toBeCloseTo(0, 9);
    expect(Math.hypot(...moved), axis).toBeGreaterThan(0.01);
    await user.press("Control+z");
    await user.settle();
  }
  for (const [axis, direction] of [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]] as const) {
    const at = await freeOfRing(axis);
    const ball = await gripOf(user, "ball");
    const [dx, dy] = [at[0] - ball[0], at[1] - ball[1]];
    await user.stroke([at, [ball[0] + dx * 0.8 - dy * 0.6, ball[1] + dy * 0.8 + dx * 0.6]]); // on, about the centre
    await user.settle();
    const { rotate } = (await poseOf(user)) ?? {};
    expect(Math.abs(dot(rotate?.axis ?? [0, 0, 0], direction)), axis).toBeCloseTo(1, 9);
    expect(Math.abs(rotate?.angle_deg ?? 0), axis).toBeGreaterThan(5);
    await user.press("Control+z");
    await user.settle();
  }
});

test("the gizmo has the handle's axes or the world's", async () => {
  await hold();
  for (const key of ["r", "z", "4", "0", "Enter"]) await user.press(key);
  await user.settle();
  const turned = (await poseOf(user)) ?? {};
  const moveAlongX = async (): Promise<Vector> => {
    const arrow = await gripOf(user, "arrow-x");
    const ball = await gripOf(user, "ball");
    await user.stroke([arrow, [arrow[0] + 0.5 * (arrow[0] - ball[0]), arrow[1] + 0.5 * (arrow[1] - ball[1])]]);
    await user.settle();
    const { translate = [0, 0, 0] } = (await poseOf(user)) ?? {};
    await user.press("Control+z");
    await user.settle();
    const length = Math.hypot(...translate);
    return [translate[0] / length, translate[1] / length, translate[2] / length];
  };
  const radians = (40 * Math.PI) / 180;
  const own = await moveAlongX();
  expect(dot(own, [Math.cos(radians), Math.sin(radians), 0])).toBeCloseTo(1, 6);
  await user.press("k");
  expect(await user.page.getByRole("button", { name: "Local axes" }).getAttribute("aria-pressed")).toBe("false");
  const world = await moveAlongX();
  expect(dot(world, [1, 0, 0])).toBeCloseTo(1, 6);
  await user.press("k");
  expect(await poseOf(user)).toEqual(turned);
});

test("a handle is put back by its key and by its button", async () => {
  await hold();
  const rest = sampled(harness, "octopus", 60);
  for (const putBack of [() => user.press("Alt+g"), () => user.click("Reset handle")]) {
    const ball = await gripOf(user, "ball");
    await user.stroke([ball, beside(ball, 10, -50)]);
    await user.settle();
    expect((await poseOf(user))?.translate).toBeDefined();
    await putBack();
    await user.settle();
    expect(await poseOf(user)).toEqual({});
    const held = await verticesOf(user);
    const at = centreOf(await harness.savedPositions(), held);
    expect(distance(at, centreOf(rest, held))).toBeLessThan(1e-6);
  }
});

test("weights, density and anchors change the surface between, and defaults bring it back", async () => {
  await hold();
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, beside(ball, -10, -80)]);
  await user.settle();
  const { page } = user;
  const more = page.getByRole("button", { name: "More settings" });
  if ((await more.getAttribute("aria-expanded")) !== "true") await more.click();
  const usual = await harness.savedPositions();
  const changed = async () => {
    await user.settle();
    const now = await harness.savedPositions();
    return Math.max(...now.map((x, i) => Math.abs(x - (usual[i] as number))));
  };
  await page.getByLabel("Weights", { exact: true }).selectOption("cotangent");
  expect(await changed()).toBeGreaterThan(1e-5);
  await page.getByLabel("Weights", { exact: true }).selectOption("uniform");
  expect(await changed()).toBe(0);
  await page.getByLabel("Density", { exact: true }).selectOption("ft05");
  expect(await changed()).toBeGreaterThan(1e-5);
  await user.click("Restore defaults");
  expect(await changed()).toBe(0);

  await page.evaluate(async () => {
    const { editor, viewport } = window.meshgraft;
    const free = [...(viewport.main?.region ?? [])].slice(10, 25);
    await editor.ask({ do: "select", how: "set", what: { indices: free } });
    await editor.ask({ do: "group", name: "soft" });
  });
  await page.getByRole("switch", { name: "soft", exact: true }).check();
  const anchored = await changed();
  expect(anchored).toBeGreaterThan(1e-5);
  const weight = page.getByRole("textbox", { name: "Weight of soft" });
  await weight.fill("500");
  await weight.press("Enter");
  expect(await changed()).toBeGreaterThan(anchored);
  await page.getByRole("switch", { name: "soft", exact: true }).uncheck();
  expect(await changed()).toBe(0);
  expect(user.complaints).toEqual([]);
});
