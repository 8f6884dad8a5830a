import { afterEach, expect, test } from "vitest";
import { EditorHarness, run, type HarnessOptions, type Point, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

async function open(options: HarnessOptions = {}): Promise<{ harness: EditorHarness; user: User }> {
  harness = await EditorHarness.open(options);
  return { harness, user: harness.user };
}

/** Opens two coarse samples in the mode Graft, the second as a part. */
async function openWithPart(
  model: string,
  part: string,
  resolution: number,
  starts = false,
): Promise<{ harness: EditorHarness; user: User }> {
  const opened = await open();
  await opened.harness.openSample(model, resolution);
  await opened.user.page.getByRole("tab", { name: "Graft" }).click();
  await opened.user.page.evaluate(
    async ([sample, resolution, starts]) => {
      await window.meshgraft.editor.graft.addPart({ sample, resolution }, starts);
    },
    [part, resolution, starts] as const,
  );
  await opened.user.page.waitForFunction(() => window.meshgraft.editor.graft.loops.value.size === 2);
  await opened.user.rests();
  return opened;
}

/** Waits until the graft of the document has been computed, and returns its report. */
async function grafted(user: User) {
  await user.page.waitForFunction(
    () => {
      const { editor } = window.meshgraft;
      const { graft, state } = editor;
      const report = graft.report.value;
      return editor.isIdle() && graft.dragged.value === null && state.value?.graft != null && report !== null && report.graft === state.value.graft.graft && !report.dragged;
    },
    undefined,
    { timeout: 90_000 },
  );
  return user.page.evaluate(() => window.meshgraft.editor.graft.report.value);
}

/** Fields of the output of `meshgraft info` for the saved mesh. */
interface Info {
  components: number;
  loops: unknown[];
  euler_characteristic: number;
  closed: boolean;
  manifold: boolean;
  oriented: boolean;
}

async function saved(harness: EditorHarness): Promise<Info> {
  const file = harness.folder.file("saved.ply");
  await harness.user.page.evaluate(async (mesh) => {
    await window.meshgraft.editor.ask({ do: "save", mesh, overwrite: true });
  }, file);
  return JSON.parse(run("info", file, "--json")) as Info;
}

const watertight = { components: 1, loops: [], closed: true, manifold: true, oriented: true };

/** Returns the screen point of a vertex of the model or of a part. */
function screenPointOf(user: User, mesh: number, vertex: number): Promise<Point> {
  return user.page.evaluate(
    ([mesh, vertex]) => {
      const { viewport, graftView } = window.meshgraft;
      const position = graftView.positionOf(mesh, vertex);
      if (position === undefined) throw new Error("there is no such mesh");
      const { x, y } = viewport.project(position);
      return [x, y] as const;
    },
    [mesh, vertex] as const,
  );
}

/** Moves the pointer to a loop until it lights up, because the view may still be moving. */
async function hoverOverLoop(user: User, mesh: number, loop: number): Promise<Point> {
  for (let patience = 20; ; --patience) {
    const at = await screenPointOnLoop(user, mesh, loop);
    await user.page.mouse.move(...at);
    const isLit = () => window.meshgraft.editor.graft.hovered.value !== null;
    const lit = await user.page.waitForFunction(isLit, undefined, { timeout: 1000 }).catch(() => undefined);
    if (lit !== undefined) return at;
    if (patience === 0) throw new Error(`loop ${loop} does not light up under the pointer`);
  }
}

/** Returns the screen point of the vertex of a loop that is nearest to the camera, so that nothing hides it. */
function screenPointOnLoop(user: User, mesh: number, loop: number): Promise<Point> {
  return user.page.evaluate(
    ([mesh, loop]) => {
      const { viewport, graftView, editor } = window.meshgraft;
      const vertices = editor.graft.loops.value.get(mesh)?.[loop]?.vertices ?? new Uint32Array();
      let best: readonly [number, number] = [0, 0];
      let nearest = Infinity;
      for (const v of vertices) {
        const position = graftView.positionOf(mesh, v);
        if (position === undefined) continue;
        const far = position.distanceTo(viewport.camera.position);
        if (far >= nearest) continue;
        const { x, y } = viewport.project(position);
        if (document.elementFromPoint(x, y) !== viewport.canvas) continue; // a panel lies over it
        nearest = far;
        best = [x, y];
      }
      return best;
    },
    [mesh, loop] as const,
  );
}

const graftOf = (user: User) => user.page.evaluate(() => window.meshgraft.editor.state.value?.graft?.step ?? null);

test("grafts a head from a fresh page within five actions", async () => {
  const { harness, user } = await open();
  await user.click(/^bust/);
  await user.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  ++user.actions;
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Add head");
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  expect(report?.seam).toMatchObject({ manifold: true, oriented: true, closed: true });
  await user.rests();
  await user.screenshot("graft-head-result");
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  ++user.actions;
  await user.settle();
  expect(user.actions).toBeLessThanOrEqual(5);
  expect(await saved(harness)).toMatchObject({ ...watertight, euler_characteristic: 2 });
  expect(user.complaints).toEqual([]);
});

test("shows how the seam bends, and the result's edges", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  const report = await grafted(user);
  await user.page.getByRole("button", { name: "View", exact: true }).click();
  await user.page.getByLabel("Heat map").selectOption("seam");
  const legend = user.page.locator(".view-legend");
  await legend.getByText("Bend across the seam's edges").waitFor();
  await user.press("z");
  await user.rests();
  await user.screenshot("graft-seam-bends");
  const largest = Number(/([\d.]+)°$/.exec((await legend.textContent()) ?? "")?.[1]);
  expect(largest).toBeGreaterThan(0);
  expect(largest).toBeLessThan(4 * (report?.seam?.dihedral_p99_deg ?? 0));
  await user.page.getByRole("radio", { name: "Apart" }).or(user.page.getByText("Apart", { exact: true })).first().click();
  await user.rests();
  expect(await legend.getByText("Bend across").isVisible()).toBe(false);
  expect(user.complaints).toEqual([]);
});

test("grafts in the document that is opened next, too, and shows no loops of the one before", async () => {
  const { harness, user } = await openWithPart("bust", "head", 20, true);
  await grafted(user);
  await harness.openSample("octopus", 20);
  await user.rests();
  const loops = () =>
    user.page.evaluate(() => window.meshgraft.graftView.clickableLoops().map(({ mesh }) => mesh));
  expect(await loops()).toEqual([]);
  await harness.openSample("bust", 20);
  await user.page.evaluate(async () => {
    const { editor } = window.meshgraft;
    if (editor.offer.value !== null) await editor.ask({ do: "discard" });
    editor.offer.value = null;
    await editor.graft.addPart({ sample: "head", resolution: 20 });
  });
  expect((await grafted(user))?.seam).toMatchObject({ manifold: true, closed: true });
  expect(user.complaints).toEqual([]);
});

test("pairs the bracket's loops with the posts' by clicks", async () => {
  const { harness, user } = await openWithPart("posts", "bracket", 40);
  const ids = await user.page.evaluate(() => window.meshgraft.editor.graft.objects.value.map(({ mesh }) => mesh));
  const [model, part] = ids as [number, number];
  // Loops whose centres are nearest in the plane belong together.
  const pairs = await user.page.evaluate(
    async ([model, part]) => {
      const { editor, viewport } = window.meshgraft;
      const centre = (mesh: number, loop: number) => {
        const vertices = editor.graft.loops.value.get(mesh)?.[loop]?.vertices ?? new Uint32Array();
        const sum = [0, 0];
        for (const v of vertices) for (const k of [0, 1]) sum[k]! += (viewport.surfaceOf(mesh)?.rest[3 * v + k] ?? 0) / vertices.length;
        return sum as [number, number];
      };
      return [0, 1, 2, 3].map((loop) => {
        const [x, y] = centre(model, loop);
        const far = [0, 1, 2, 3].map((other) => {
          const [u, v] = centre(part, other);
          return Math.hypot(u - x, v - y);
        });
        return [loop, far.indexOf(Math.min(...far))] as const;
      });
    },
    [model, part] as const,
  );
  await user.screenshot("graft-bracket-apart");
  for (const [target, source] of pairs) {
    await user.page.evaluate(() => (window.meshgraft.editor.graft.arrangement.value = "apart"));
    await user.rests();
    await user.clickAt(await hoverOverLoop(user, model, target));
    await user.page.waitForFunction(() => window.meshgraft.editor.graft.picked.value !== null);
    await user.clickAt(await screenPointOnLoop(user, part, source));
    await user.page.waitForFunction(() => window.meshgraft.editor.isIdle());
  }
  const report = await grafted(user);
  const step = await graftOf(user);
  expect((step as { pairs: unknown[] } | null)?.pairs).toHaveLength(4);
  expect(report?.error).toBeUndefined();
  await user.page.evaluate(() => (window.meshgraft.editor.graft.arrangement.value = "both"));
  await user.rests();
  await user.screenshot("graft-bracket-paired");
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  const result = await saved(harness);
  expect(result).toMatchObject({ components: 1, loops: [], manifold: true, oriented: true });
  expect(user.complaints).toEqual([]);
}, 240_000);

test("turns, twists, mirrors and reshapes while it shows what comes of it, and undoes all", async () => {
  const { harness, user } = await openWithPart("bust", "head", 40, true);
  const first = await grafted(user);
  expect(first?.error).toBeUndefined();
  const slide = async (label: string, by: number) => {
    const track = user.page.getByRole("slider", { name: label });
    const box = await track.boundingBox();
    if (box === null) throw new Error(`there is no slider ${label}`);
    await user.stroke([[box.x + box.width / 2, box.y + box.height / 2], [box.x + box.width * (0.5 + by), box.y + box.height / 2]], { steps: 10 });
    await grafted(user);
  };
  await slide("Normal angle", 0.1);
  expect(await graftOf(user)).toMatchObject({ normal_angle_deg: expect.closeTo(18, -1) });
  const before = ((await graftOf(user)) as { normal_angle_deg: number }).normal_angle_deg;
  const angle = user.page.getByRole("slider", { name: "Normal angle" });
  await angle.press("ArrowRight");
  await grafted(user);
  expect(await graftOf(user)).toMatchObject({ normal_angle_deg: Math.round(before) + 1 });
  const field = user.page.getByRole("textbox", { name: "Twist" });
  await field.fill("180");
  await field.press("Enter");
  await grafted(user);
  expect(await field.inputValue()).not.toMatch(/^[-−]/);
  await field.press("ArrowUp"); // a step beyond the range is refused with a message
  await user.page.getByRole("alert").getByText("-180 to 180", { exact: true }).waitFor();
  expect(await field.inputValue()).not.toMatch(/^[-−]/);
  await field.fill("0");
  await field.press("Enter");
  await grafted(user);
  await slide("Twist", 0.25);
  const twist = await user.page.evaluate(() => window.meshgraft.editor.graft.starts.twistOf(0));
  expect(Math.abs(twist - 90)).toBeLessThan(25);
  await user.screenshot("graft-head-twisted");
  await user.page.getByLabel("Mirror").selectOption("x");
  const mirrored = await grafted(user);
  const [a, b, c] = (mirrored?.transform ?? []) as number[][];
  const det = (m: number[][]) =>
    m[0]![0]! * (m[1]![1]! * m[2]![2]! - m[1]![2]! * m[2]![1]!) -
    m[0]![1]! * (m[1]![0]! * m[2]![2]! - m[1]![2]! * m[2]![0]!) +
    m[0]![2]! * (m[1]![0]! * m[2]![1]! - m[1]![1]! * m[2]![0]!);
  expect(det([a!, b!, c!])).toBeLessThan(0);
  await user.page.getByText("Bends", { exact: true }).click();
  await grafted(user);
  expect(await graftOf(user)).toMatchObject({ shape: "ft05" });
  for (let i = 0; i < 12; ++i) {
    if ((await user.page.evaluate(() => window.meshgraft.editor.state.value?.undo)) === null) break;
    await user.press("Control+z");
    await user.page.waitForFunction(() => window.meshgraft.editor.isIdle());
  }
  const left = await user.page.evaluate(() => {
    const { state, graft } = window.meshgraft.editor;
    return { undo: state.value?.undo, parts: state.value?.parts.length, graft: state.value?.graft, preview: graft.preview.value };
  });
  expect(left).toEqual({ undo: null, parts: 0, graft: null, preview: null });
  await user.screenshot("graft-undone");
  expect(harness.user.complaints).toEqual([]);
}, 240_000);

test("drags what meets along the loop, adds a match and takes it away", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  await grafted(user);
  await user.page.getByText("Apart", { exact: true }).click();
  await user.rests();
  const { part, start, loop } = await user.page.evaluate(() => {
    const { graft } = window.meshgraft.editor;
    const part = graft.source.value?.mesh ?? -1;
    return { part, start: graft.starts.of(0) ?? [0, 0], loop: [...(graft.loops.value.get(part)?.[0]?.vertices ?? [])] };
  });
  const at = loop.indexOf(start[0]);
  const path = [0, 1, 2, 3, 4].map((k) => loop[(at + k) % loop.length] as number);
  const stroke = [];
  for (const v of path) stroke.push(await screenPointOf(user, part, v));
  await user.stroke(stroke, { steps: 3 });
  await grafted(user);
  const moved = await user.page.evaluate(() => window.meshgraft.editor.graft.starts.of(0));
  expect(moved?.[0]).toBe(path[4]);
  await user.screenshot("graft-start-dragged");
  const other = await screenPointOf(user, part, loop[(at + Math.floor(loop.length / 2)) % loop.length] as number);
  await user.page.mouse.dblclick(...other);
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.pairs.value[0]?.matches.length === 1);
  await grafted(user);
  await user.press("Delete");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.pairs.value[0]?.matches.length === 0);
  expect(user.complaints).toEqual([]);
}, 240_000);

test("keeps the pose of a part that the gizmo moves, and what is painted fixed", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  await grafted(user);
  await user.page.getByText("Keep", { exact: true }).click();
  await grafted(user);
  const before = (await graftOf(user)) as { source_transform: number[][] };
  const ball = user.page.locator('.gizmo [data-part="arrow-z"] .halo');
  const box = await ball.boundingBox();
  if (box === null) throw new Error("there is no gizmo");
  const grip: Point = [box.x + box.width / 2, box.y + 14];
  await user.stroke([grip, [grip[0], grip[1] - 25]], { steps: 8 });
  const report = await grafted(user);
  const after = (await graftOf(user)) as { source_transform: number[][] };
  expect(after.source_transform[2]![3]! - before.source_transform[2]![3]!).toBeGreaterThan(0.01);
  await user.screenshot("graft-kept-pose");
  expect(report?.graft).toBeGreaterThan(0);
  await user.click("Paint what stays");
  await user.rests();
  const part = await user.page.evaluate(() => window.meshgraft.editor.graft.source.value?.mesh ?? -1);
  const face = await user.page.evaluate((mesh) => {
    const { viewport, graftView } = window.meshgraft;
    const position = graftView.centreOf(mesh);
    const { x, y } = viewport.project(position);
    return [x, y] as const;
  }, part);
  await user.stroke([face, [face[0] + 25, face[1]]]);
  await grafted(user);
  expect(await graftOf(user)).toHaveProperty("fixed");
  await user.screenshot("graft-fixed-painted");
  expect(user.complaints).toEqual([]);
}, 240_000);

test("a line that begins and ends off the model sets the plane, and the sides are blue and red", async () => {
  const { harness, user } = await open();
  await harness.openSample("octopus", 40);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  const cameraPosition = () => user.page.evaluate(() => window.meshgraft.viewport.camera.position.toArray());
  const start = await cameraPosition();
  await user.stroke([[200, 680], [260, 640]]); // off the model, without a cutting tool
  await user.rests();
  expect(await cameraPosition()).not.toEqual(start);
  await user.click("Cut by a plane");
  await user.rests();
  const before = await cameraPosition();
  const middle = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y] as const;
  });
  await user.stroke([[110, middle[1] - 10], [800, middle[1] - 10]], { steps: 12 });
  await user.rests();
  expect(await cameraPosition()).toEqual(before);
  const picture = (await user.page.screenshot()).toString("base64");
  const sides = await user.page.evaluate(async (png) => {
    const image = new Image();
    image.src = `data:image/png;base64,${png}`;
    await image.decode();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [image.width, image.height];
    const context = copy.getContext("2d");
    context?.drawImage(image, 0, 0);
    const seen = { red: 0, blue: 0 };
    for (let y = 0; y < image.height; y += 6)
      for (let x = 0; x < image.width; x += 6) {
        if (window.meshgraft.viewport.pick(x, y) === undefined) continue;
        const [r = 0, , b = 0] = context?.getImageData(x, y, 1, 1).data ?? [];
        if (Math.abs(r - b) > 25) seen[r > b ? "red" : "blue"] += 1;
      }
    return seen;
  }, picture);
  await user.screenshot("cut-line-beside");
  expect(sides.red).toBeGreaterThan(50);
  expect(sides.blue).toBeGreaterThan(50);
  await user.click("Keep blue side");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  expect(await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.loops)).toBeGreaterThan(0);
  expect(user.complaints).toEqual([]);
}, 120_000);

test("cuts by a plane and along a curve, and keeps the other side instead", async () => {
  const { harness, user } = await open();
  await harness.openSample("octopus", 40);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Cut by a plane");
  const middle = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y] as const;
  });
  await user.stroke([[middle[0] - 60, middle[1]], [middle[0] + 60, middle[1]]]);
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.cutPlane.value !== null);
  await user.screenshot("cut-plane");
  const faces = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.faces ?? 0);
  await user.click("Keep blue side");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  const cut = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model);
  expect(cut?.faces).toBeLessThan(faces);
  expect(cut?.loops).toBeGreaterThan(0);
  await user.screenshot("cut-plane-done");
  await user.page.evaluate(() => window.meshgraft.editor.graft.cutOtherwise());
  await user.settle();
  const other = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.faces ?? 0);
  expect(other).not.toBe(cut?.faces);
  await user.press("Control+z");
  await user.settle();
  await user.click("Cut along a curve");
  await user.rests();
  const c = await user.page.evaluate(() => {
    const { viewport, graftView } = window.meshgraft;
    const { x, y } = viewport.project(graftView.centreOf(viewport.main?.id ?? -1));
    return [x, y - 60] as const;
  });
  const round = Array.from({ length: 25 }, (_, i): Point => [c[0] + 32 * Math.cos((i * Math.PI) / 12), c[1] + 28 * Math.sin((i * Math.PI) / 12)]);
  await user.stroke(round, { steps: 3 });
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.cutCurve.value?.closed === true);
  await user.screenshot("cut-curve");
  await user.press("Enter");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.lastCut.value !== null);
  await user.settle();
  const piece = await user.page.evaluate(() => window.meshgraft.editor.state.value?.model);
  expect(piece?.loops).toBe(1);
  expect(piece?.faces).toBeLessThan(faces / 2);
  await user.screenshot("cut-curve-done");
  expect(user.complaints).toEqual([]);
}, 240_000);

/** Returns the rectangle around a mesh on the page: left, top, right, bottom. */
function boxOnPage(user: User, mesh: "model" | "part"): Promise<[number, number, number, number]> {
  return user.page.evaluate((which) => {
    const { editor, viewport, graftView } = window.meshgraft;
    const object = which === "model" ? editor.graft.model.value : editor.graft.parts.value[0];
    const count = viewport.surfaceOf(object?.mesh ?? -1)?.vertexCount ?? 0;
    const box: [number, number, number, number] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let v = 0; v < count; ++v) {
      const { x, y } = viewport.project(graftView.positionOf(object?.mesh ?? -1, v)!);
      box[0] = Math.min(box[0], x);
      box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x);
      box[3] = Math.max(box[3], y);
    }
    return box;
  }, mesh);
}

test("puts a part to the right of the model, from wherever that is seen", async () => {
  const { harness, user } = await open();
  await harness.openSample("bust", 20);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  for (const [yaw, pitch] of [[0, 0], [2, 0.3], [2.2, -0.6]] as const) {
    await user.page.evaluate(
      async ([yaw, pitch]) => {
        const { editor, viewport } = window.meshgraft;
        viewport.navigation.orbit(yaw, pitch);
        await editor.graft.addPart({ sample: "head", resolution: 20 }, false);
      },
      [yaw, pitch] as const,
    );
    await user.page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 1);
    await user.rests();
    const [part, model] = [await boxOnPage(user, "part"), await boxOnPage(user, "model")];
    expect(part[0]).toBeGreaterThan(model[2] + 5);
    await user.screenshot(`graft-beside-${Math.round(10 * yaw)}`);
    await user.press("Control+z");
    await user.page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 0);
  }
  expect(user.complaints).toEqual([]);
}, 120_000);

test("drops a part from the library onto the surface", async () => {
  const { harness, user } = await open();
  await harness.openSample("torus", 40);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.rests(); // the camera still frames the model
  const thumbnail = await user.page.getByRole("button", { name: "Add cylinder" }).boundingBox();
  if (thumbnail === null) throw new Error("the library is not shown");
  await user.page.mouse.move(thumbnail.x + 30, thumbnail.y + 30);
  await user.page.mouse.down();
  const status = user.page.getByRole("contentinfo", { name: "Status" });
  await status.getByText("Add a part from the library").waitFor();
  const cameraMatrix = () => user.page.evaluate(() => window.meshgraft.viewport.camera.matrixWorld.toArray());
  const shownBeside = () =>
    user.page.evaluate(() => window.meshgraft.viewport.parts.shown().map(({ surface }) => surface.id));
  const seen = await cameraMatrix();
  await user.page.mouse.move(500, 420, { steps: 5 });
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.dropped.value !== null);
  await status.getByText("Point where the part is to grow").waitFor();
  await user.rests();
  expect(await shownBeside()).toEqual([]); // the part is shown only at the pointer
  await user.screenshot("drop-loaded");
  await user.page.keyboard.press("Escape");
  await user.page.mouse.up();
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 0);
  expect(await cameraMatrix()).toEqual(seen);
  expect(await user.page.getByText(/was let go beside the surface/).count()).toBe(0);

  const offSurface: Point = await user.page.evaluate(() => {
    const { canvas } = window.meshgraft.viewport;
    const { left, bottom } = canvas.getBoundingClientRect();
    return [left + 30, bottom - 120] as const;
  });
  await user.stroke([[thumbnail.x + 30, thumbnail.y + 30], [500, 420], offSurface]);
  await user.page.getByText("Cylinder was let go beside the surface, so nothing is added").waitFor();
  await user.screenshot("drop-missed");
  expect(await user.page.evaluate(() => window.meshgraft.editor.graft.parts.value.length)).toBe(0);
  expect(await graftOf(user)).toBeNull();
  expect(await cameraMatrix()).toEqual(seen);
  await user.press("Escape");
  await user.page.evaluate(async () => {
    await window.meshgraft.editor.graft.addPart({ sample: "head", resolution: 40 }, false);
  });
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 1);
  await user.rests();
  const row = await user.page.getByRole("button", { name: "Graft head" }).boundingBox();
  if (row === null) throw new Error("the part is not listed");
  const point = await user.page.evaluate(() => {
    const { viewport } = window.meshgraft;
    const surface = viewport.main!;
    let best: readonly [number, number] = [0, 0];
    let nearest = Infinity;
    for (let v = 0; v < surface.vertexCount; v += 3) {
      const position = surface.positionOf(v);
      const far = position.distanceTo(viewport.camera.position);
      if (far >= nearest) continue;
      nearest = far;
      const { x, y } = viewport.project(position);
      best = [x, y];
    }
    return best;
  });
  await user.page.mouse.move(row.x + 20, row.y + 12);
  await user.page.mouse.down();
  await user.page.mouse.move(point[0] + 60, point[1] - 20, { steps: 6 });
  await user.page.mouse.move(...point, { steps: 6 });
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.dragged.value?.at != null);
  await user.page.keyboard.press("r");
  await user.page.mouse.wheel(0, 100);
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.transform.value !== null);
  await user.rests();
  await user.screenshot("drop-dragged");
  expect(await shownBeside()).toEqual([]);
  const before = await cameraMatrix();
  await user.page.mouse.up();
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  expect(await shownBeside()).toEqual([]);
  expect(await cameraMatrix()).toEqual(before);
  await status.getByText("Grafted; Accept keeps it").waitFor();
  const counts = await user.page.evaluate(() => {
    const frame = window.meshgraft.editor.graft.preview.value;
    return { shown: frame?.indices("triangles")?.length ?? 0, model: window.meshgraft.editor.state.value?.model.faces };
  });
  expect(counts.shown / 3).not.toBe(counts.model);
  await status.getByText(`${String(counts.shown / 3).replace(/\B(?=(\d{3})+$)/g, "\u202f")} faces`).waitFor();
  expect(await graftOf(user)).toMatchObject({ source: "head", at: { spin_deg: 22.5 } });
  await user.rests();
  await user.screenshot("drop-done");
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  expect(await saved(harness)).toMatchObject({ ...watertight, euler_characteristic: 0 });
  expect(user.complaints).toEqual([]);
}, 240_000);

test("a dropped part that reaches out of the view comes into it", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("torus", 40);
  await page.getByRole("tab", { name: "Graft" }).click();
  await page.evaluate(() => window.meshgraft.editor.graft.addPart({ sample: "head", resolution: 40 }, false));
  await page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 1);
  await user.rests();
  const highest = () =>
    page.evaluate(() => {
      const { viewport, editor } = window.meshgraft;
      const positions = editor.graft.preview.value?.floats("positions") ?? viewport.main?.rest ?? new Float32Array();
      const at = Array.from({ length: positions.length / 3 }, (_, v) => positions[3 * v + 2]!);
      const top = viewport.camera.position.clone().fromArray(positions, 3 * at.indexOf(Math.max(...at)));
      return viewport.project(top).y - viewport.canvas.getBoundingClientRect().top;
    });
  await page.mouse.move(480, 400);
  for (let i = 0; i < 12 && (await highest()) > 40; ++i) await page.mouse.wheel(0, -240).then(() => user.rests());
  await page.evaluate(() => window.meshgraft.editor.graft.set({ source: "head", at: { point: [0, 1, 0.8] } }));
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  await user.rests();
  await user.screenshot("drop-framed");
  expect(await highest()).toBeGreaterThan(0);
  expect(user.complaints).toEqual([]);
}, 120_000);
