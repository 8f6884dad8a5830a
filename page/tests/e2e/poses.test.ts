// Poses without a motion (a redrawn curve, a matrix in a file), and a slow set-up.
import { writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { distance, exported, gripOf, positionOf, poseOf, verticesOf } from "./grips";
import { positionsOf, Stage, type Person, type StageOptions } from "./harness";

let stage: Stage | undefined;
afterEach(async () => {
  await stage?.close();
  stage = undefined;
});

async function start(options: StageOptions) {
  stage = await Stage.open(options);
  stage.person.page.setDefaultTimeout(20_000);
  return { stage, person: stage.person, page: stage.person.page };
}

async function openListed(person: Person, name: RegExp): Promise<void> {
  await person.page.getByRole("button", { name }).first().click();
  await person.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await person.settle();
}

/** Returns the text of an edit file of a bar with this handle. */
function editWith(handle: object): string {
  return JSON.stringify({
    format: "meshgraft-edit",
    version: 2,
    inputs: { bar: { file: "bar.obj" } },
    steps: [
      {
        kind: "deform",
        mesh: "bar",
        region: { half_space: { point: [0, 0, 0], normal: [0, 0, 1] } },
        handles: [handle],
      },
    ],
  });
}

const bar = { "bar.obj": ["bar", "--resolution", "8"] };

test("a matrix of a file gets a gizmo, and goes on from where it was", async () => {
  const { stage, person, page } = await start({ files: bar });
  const matrix = [
    [1, 0, 0, 0.5],
    [0, 1, 0, 0],
    [0, 0, 1, 0],
    [0, 0, 0, 1],
  ];
  writeFileSync(stage.folder.file("top.def"), matrix.map((row) => row.join(" ")).join("\n"));
  const select = { half_space: { point: [0, 0, 1.8], normal: [0, 0, 1] } };
  writeFileSync(
    stage.folder.file("bar_edit.json"),
    editWith({ name: "top", select, pose: { def: "top.def" } }),
  );
  await person.page.reload();
  await openListed(person, /bar_edit\.json/);
  await page.getByRole("button", { name: /^top/ }).first().click();
  const before = positionsOf(await exported(stage, "before", ".obj"));
  const ball = await gripOf(person, "ball");
  await person.screenshot("poses-file");
  await person.stroke([ball, [ball[0] + 50, ball[1] - 30]]);
  await person.settle();
  const pose = await poseOf(person, "top");
  expect(pose?.def).toBeUndefined();
  const shift = (pose?.matrix ?? []).map((row) => row[3]).slice(0, 3) as number[];
  expect(distance(shift, [0.5, 0, 0])).toBeGreaterThan(0.1);
  const after = positionsOf(await exported(stage, "after", ".obj"));
  for (const v of await verticesOf(person, "top")) {
    const by = positionOf(after, v).map((x, k) => x - (positionOf(before, v)[k] as number));
    expect(distance(by, [shift[0]! - 0.5, shift[1]!, shift[2]!])).toBeLessThan(1e-5);
  }
  expect(person.complaints).toEqual([]);
}, 120_000);

test("a curve that was redrawn gets a gizmo, and is moved and turned as a whole", async () => {
  const { stage, person, page } = await start({ files: bar });
  const course = [
    [-0.6, -0.5, 2.4],
    [0, -0.6, 2.6],
    [0.6, -0.5, 2.4],
  ];
  const handle = {
    name: "edge",
    shape: "curve",
    closed: false,
    select: {
      path: {
        points: [
          [-0.5, -0.5, 2],
          [0.5, -0.5, 2],
        ],
      },
    },
    pose: { curve: course },
  };
  writeFileSync(stage.folder.file("bar_edit.json"), editWith(handle));
  await page.reload();
  await openListed(person, /bar_edit\.json/);
  await page.getByRole("button", { name: /^edge/ }).first().click();
  const before = positionsOf(await exported(stage, "before", ".obj"));
  const arrow = await gripOf(person, "arrow-y"); // the y axis is vertical in this file
  await person.screenshot("poses-curve");
  await person.stroke([arrow, [arrow[0], arrow[1] - 40]]);
  await person.settle();
  const moved = (await poseOf(person, "edge"))?.curve ?? [];
  expect(moved).toHaveLength(3);
  const up = moved[0]![1] - course[0]![1]!;
  expect(up).toBeGreaterThan(0.1);
  moved.forEach((point, i) =>
    expect(distance(point, [course[i]![0]!, course[i]![1]! + up, course[i]![2]!])).toBeLessThan(1e-9),
  );
  const after = positionsOf(await exported(stage, "after", ".obj"));
  for (const v of await verticesOf(person, "edge")) {
    const [x, y, z] = positionOf(before, v);
    expect(distance(positionOf(after, v), [x, y + up, z])).toBeLessThan(1e-5);
  }
  for (const key of ["r", "z", "9", "0", "Enter"]) await person.press(key);
  await person.settle();
  const turned = (await poseOf(person, "edge"))?.curve ?? [];
  const middle = [0, 1, 2].map((k) => moved.reduce((sum, point) => sum + point[k as 0] / 3, 0)) as number[];
  turned.forEach((point, i) => {
    const [x, y, z] = moved[i]!.map((part, k) => part - middle[k]!) as [number, number, number];
    expect(distance(point, [middle[0]! - y, middle[1]! + x, middle[2]! + z])).toBeLessThan(1e-9);
  });
  await person.screenshot("poses-curve-turned");
  for (let i = 0; i < 2; ++i) await person.press("Control+z");
  await person.settle();
  expect((await poseOf(person, "edge"))?.curve).toEqual(course);
  expect(person.complaints).toEqual([]);
}, 120_000);

test("a long set-up is cancelled, and what was before is there at once", async () => {
  const { person, page } = await start({ models: { "bar.ply": ["bar", "--resolution", "480"] } });
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.model.vertices ?? 0)).toBeGreaterThan(
    200_000,
  );
  // The region is the whole model, whose set-up is the slowest.
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const above = (z: number) => ({ half_space: { point: [0, 0, z], normal: [0, 0, 1] } });
    await editor.ask({ do: "region", select: "all" });
    await editor.ask({ do: "fixed", select: { half_space: { point: [0, 0, 0.2], normal: [0, 0, -1] } } });
    await editor.ask({ do: "settings", settings: { method: "ft05" } });
    await editor.ask({ do: "handle", what: "add", name: "top", select: above(3.8) });
    await editor.pose({ top: { translate: [0.5, 0, 0] } });
  });
  await person.settle();
  const state = () =>
    page.evaluate(() =>
      JSON.stringify({ ...window.meshgraft.editor.state.value, redo: null, set_up_for: null }),
    );
  const shown = () => page.evaluate(() => window.meshgraft.viewport.main?.positions[0]);
  const [before, height] = [await state(), await shown()];
  await page.getByText("Natural", { exact: true }).click();
  const cancel = page.locator(".status").getByRole("button", { name: "Cancel" });
  await cancel.waitFor();
  await page.waitForFunction(
    () => (window.meshgraft.editor.state.value?.settings as { method?: string }).method === "corotational",
  );
  await person.screenshot("poses-set-up");
  const began = performance.now();
  await cancel.click();
  await page.waitForFunction(
    () => (window.meshgraft.editor.state.value?.settings as { method?: string }).method === "ft05",
  );
  await person.settle();
  expect(performance.now() - began).toBeLessThan(5000);
  expect(await state()).toBe(before);
  expect(await shown()).toBeCloseTo(height ?? NaN, 9);
  expect(await page.evaluate(() => window.meshgraft.editor.live.value.stage)).toBe("ready");
  await person.screenshot("poses-set-up-cancelled");
  const redo = await page.evaluate(() => window.meshgraft.editor.state.value?.redo);
  expect(redo).toBe("settings"); // the change can be redone
  expect(person.complaints).toEqual([]);
}, 300_000);
