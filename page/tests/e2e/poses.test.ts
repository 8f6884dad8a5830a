// Poses without a motion: a redrawn curve, a matrix in a file.
import { writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { distance, exported, gripOf, positionOf, poseOf, verticesOf } from "./grips";
import { EditorHarness, positionsOf, type HarnessOptions, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

async function start(options: HarnessOptions) {
  harness = await EditorHarness.open(options);
  return { harness, user: harness.user, page: harness.user.page };
}

async function openListed(user: User, name: RegExp): Promise<void> {
  await user.page.getByRole("button", { name }).first().click();
  await user.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await user.settle();
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
  const { harness, user, page } = await start({ files: bar });
  const matrix = [
    [1, 0, 0, 0.5],
    [0, 1, 0, 0],
    [0, 0, 1, 0],
    [0, 0, 0, 1],
  ];
  writeFileSync(harness.folder.file("top.def"), matrix.map((row) => row.join(" ")).join("\n"));
  const select = { half_space: { point: [0, 0, 1.8], normal: [0, 0, 1] } };
  writeFileSync(
    harness.folder.file("bar_edit.json"),
    editWith({ name: "top", select, pose: { def: "top.def" } }),
  );
  await user.page.reload();
  await user.ready();
  await openListed(user, /bar_edit\.json/);
  await page.getByRole("button", { name: /^top/ }).first().click();
  const before = positionsOf(await exported(harness, "before", ".obj"));
  const ball = await gripOf(user, "ball");
  await user.screenshot("poses-file");
  await user.stroke([ball, [ball[0] + 50, ball[1] - 30]]);
  await user.settle();
  const pose = await poseOf(user, "top");
  expect(pose?.def).toBeUndefined();
  const shift = (pose?.matrix ?? []).map((row) => row[3]).slice(0, 3) as number[];
  expect(distance(shift, [0.5, 0, 0])).toBeGreaterThan(0.1);
  const after = positionsOf(await exported(harness, "after", ".obj"));
  for (const v of await verticesOf(user, "top")) {
    const by = positionOf(after, v).map((x, k) => x - (positionOf(before, v)[k] as number));
    expect(distance(by, [shift[0]! - 0.5, shift[1]!, shift[2]!])).toBeLessThan(1e-5);
  }
  expect(user.complaints).toEqual([]);
});

test("a curve that was redrawn gets a gizmo, and is moved and turned as a whole", async () => {
  const { harness, user, page } = await start({ files: bar });
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
  writeFileSync(harness.folder.file("bar_edit.json"), editWith(handle));
  await page.reload();
  await user.ready();
  await openListed(user, /bar_edit\.json/);
  await page.getByRole("button", { name: /^edge/ }).first().click();
  const before = positionsOf(await exported(harness, "before", ".obj"));
  const arrow = await gripOf(user, "arrow-y"); // the y axis is vertical in this file
  await user.screenshot("poses-curve");
  await user.stroke([arrow, [arrow[0], arrow[1] - 40]]);
  await user.settle();
  const moved = (await poseOf(user, "edge"))?.curve ?? [];
  expect(moved).toHaveLength(3);
  const up = moved[0]![1] - course[0]![1]!;
  expect(up).toBeGreaterThan(0.1);
  moved.forEach((point, i) =>
    expect(distance(point, [course[i]![0]!, course[i]![1]! + up, course[i]![2]!])).toBeLessThan(1e-9),
  );
  const after = positionsOf(await exported(harness, "after", ".obj"));
  for (const v of await verticesOf(user, "edge")) {
    const [x, y, z] = positionOf(before, v);
    expect(distance(positionOf(after, v), [x, y + up, z])).toBeLessThan(1e-5);
  }
  for (const key of ["r", "z", "9", "0", "Enter"]) await user.press(key);
  await user.settle();
  const turned = (await poseOf(user, "edge"))?.curve ?? [];
  const middle = [0, 1, 2].map((k) => moved.reduce((sum, point) => sum + point[k as 0] / 3, 0)) as number[];
  turned.forEach((point, i) => {
    const [x, y, z] = moved[i]!.map((part, k) => part - middle[k]!) as [number, number, number];
    expect(distance(point, [middle[0]! - y, middle[1]! + x, middle[2]! + z])).toBeLessThan(1e-9);
  });
  await user.screenshot("poses-curve-turned");
  for (let i = 0; i < 2; ++i) await user.press("Control+z");
  await user.settle();
  expect((await poseOf(user, "edge"))?.curve).toEqual(course);
  expect(user.complaints).toEqual([]);
});
