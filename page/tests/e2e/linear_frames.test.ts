import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

test("the vertex shader puts vertices where the engine's exact linear frame has them", async () => {
  const { page } = harness.user;
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "open", sample: "octopus", resolution: 60 }));
  await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  const poses = await page.evaluate(async () => {
    const { editor, viewport } = window.meshgraft;
    const surface = viewport.main;
    if (surface === undefined) throw new Error("nothing is shown");
    const { rest, offset } = surface;
    const size = surface.box.diagonal;
    const moved = [
      { rotate: { axis: [0.2, 1, 0.3], angle_deg: 170 }, translate: [0.1 * size, 0, 0.1 * size] },
      { rotate: { axis: [0, 0, 1], angle_deg: 100 }, scale: 2.5 },
      { rotate: { axis: [1, 0, 0], angle_deg: -75 }, scale: [0.3, 1.5, 2] },
    ];
    const names: Record<string, object> = {};
    for (const [i, [axis, sign]] of (
      [
        [0, 1],
        [2, 1],
        [1, -1],
      ] as const
    ).entries()) {
      let tip = 0;
      for (let v = 0; v < rest.length / 3; ++v)
        if (sign * (rest[3 * v + axis] ?? 0) > sign * (rest[3 * tip + axis] ?? 0)) tip = v;
      const at = [0, 1, 2].map((k) => rest[3 * tip + k] ?? 0);
      const near = [...Array(rest.length / 3).keys()].filter(
        (v) => Math.hypot(...at.map((x, k) => (rest[3 * v + k] ?? 0) - x)) < 0.05 * size,
      );
      const answer = await editor.ask({ do: "paint-handle", vertices: near, reach: 0.25 * size });
      const name = answer !== undefined && "name" in answer ? (answer.name ?? "") : "";
      names[name] = { ...moved[i], pivot: at.map((x, k) => x + (offset[k] ?? 0)) };
    }
    await editor.ask({ do: "settings", settings: { method: "ft05" } });
    return names;
  });
  expect(Object.keys(poses)).toHaveLength(3);
  await page.waitForFunction(() => window.meshgraft.viewport.main?.linear.isReady === true);

  const pose = await page.evaluate(async (given) => {
    const answer = await window.meshgraft.editor.pose(given);
    return answer !== undefined && "pose" in answer ? (answer.pose ?? 0) : 0;
  }, poses as never);
  await page.waitForFunction((number) => {
    const live = window.meshgraft.editor.live.value;
    return live.accuracy === "exact" && (live.pose ?? 0) >= number;
  }, pose);
  const { worst, moved } = await page.evaluate(async () => {
    const { viewport } = window.meshgraft;
    const surface = viewport.main;
    if (surface === undefined) throw new Error("nothing is shown");
    const exact = surface.positions.slice();
    if (!viewport.showPoses(new Map())) throw new Error("there are no weights");
    const shader = await viewport.readPositions();
    const furthest = (a: Float32Array, b: Float32Array) =>
      a.reduce((most, x, i) => Math.max(most, Math.abs(x - (b[i] ?? NaN))), 0);
    return {
      worst: furthest(exact, shader) / surface.box.diagonal,
      moved: furthest(exact, surface.rest) / surface.box.diagonal,
    };
  });
  expect(moved).toBeGreaterThan(0.1);
  expect(worst).toBeLessThan(1e-5);
});
