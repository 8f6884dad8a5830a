import { afterEach, expect, test } from "vitest";
import { close, grafted, graftOf, open, saved, watertight } from "./grafting";
import type { Point, User } from "./harness";

afterEach(close);

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
});

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
  await status.getByText("Point at the surface; click or release to graft").waitFor();
  await user.rests();
  expect(await shownBeside()).toEqual([]); // the part is shown only at the pointer
  await user.screenshot("drop-loaded");
  await user.page.keyboard.press("Escape");
  await user.page.mouse.up();
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 0);
  expect(await cameraMatrix()).toEqual(seen);
  expect(await user.page.getByText(/was released off the surface/).count()).toBe(0);

  const offSurface: Point = await user.page.evaluate(() => {
    const { canvas } = window.meshgraft.viewport;
    const { left, bottom } = canvas.getBoundingClientRect();
    return [left + 30, bottom - 120] as const;
  });
  await user.stroke([[thumbnail.x + 30, thumbnail.y + 30], [500, 420], offSurface]);
  await user.page.getByText("Cylinder was released off the surface, so nothing was added").waitFor();
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
  await user.wheel(100);
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
  await status.getByText("Grafted; Accept to finish").waitFor();
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

test("opens a closed part where it is dropped, at a height that the wheel changes", async () => {
  const { harness, user } = await open();
  await harness.openSample("bar", 20);
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.rests();
  const before = await user.page.evaluate(() => window.meshgraft.editor.graft.parts.value.length);
  const begin = () =>
    user.page.evaluate(async () => {
      const { graft } = window.meshgraft.editor;
      await graft.beginDrop(() => graft.addPart({ sample: "cactus", resolution: 24 }, false));
    });
  const middle = async (): Promise<Point> => {
    const [left, top, right, bottom] = await boxOnPage(user, "model");
    return [(left + right) / 2, (top + bottom) / 2];
  };
  const shownBase = () => user.page.evaluate(() => window.meshgraft.editor.graft.report.value?.base?.height);
  const whenShown = () =>
    user.page.waitForFunction(() => {
      const { graft } = window.meshgraft.editor;
      return graft.report.value?.base !== undefined && graft.preview.value !== null;
    }, undefined, { timeout: 90_000 });

  // A drop that is cancelled leaves nothing behind.
  await begin();
  await user.page.mouse.move(...(await middle()), { steps: 4 });
  await whenShown();
  await user.press("Escape");
  await user.page.waitForFunction(
    (count) => {
      const { graft } = window.meshgraft.editor;
      return graft.parts.value.length === count && graft.preview.value === null && graft.dropped.value === null;
    },
    before,
  );
  expect(await graftOf(user)).toBeNull();

  await begin();
  const [x, y] = await middle();
  await user.page.mouse.move(x + 2, y, { steps: 4 });
  await whenShown();
  const first = await shownBase();
  await user.page.getByText(/cut open (by itself|at)/).first().waitFor();
  await user.page.keyboard.down("Alt");
  await user.wheel(-300);
  await user.page.keyboard.up("Alt");
  await user.page.waitForFunction(
    (height) => (window.meshgraft.editor.graft.report.value?.base?.height ?? 0) > 1.3 * (height ?? 0),
    first,
    { timeout: 90_000 },
  );
  await user.press("t");
  await user.page.getByText(/tilted 5°/).first().waitFor();
  await user.screenshot("drop-closed-dragged");
  await user.page.mouse.down();
  await user.page.mouse.up();
  const report = await grafted(user);
  expect(report?.error).toBeUndefined();
  expect(report?.base?.height).toBeGreaterThan(1.3 * (first ?? 0));
  await user.page.getByRole("slider", { name: "Base" }).or(user.page.getByLabel("Base")).first().waitFor();
  expect(await graftOf(user)).toMatchObject({ at: { base: { tilt_deg: 5 } } });
  await user.page.getByRole("slider", { name: "Base tilt" }).waitFor();
  await user.rests();
  await user.screenshot("drop-closed-done");

  // The grips of the plane: up for a larger height, and a tilt; one change each.
  const knobAt = async (grip: string): Promise<Point> => {
    const box = await user.page.locator(`.base-knob.${grip} .disc`).boundingBox();
    if (box === null) throw new Error(`no grip for the ${grip}`);
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const base = () => user.page.evaluate(() => window.meshgraft.editor.graft.kept.value?.at?.base);
  const heightBefore = report?.base?.height ?? 0;
  // The stem of the first grip lies along the normal.
  const along = await user.page.locator(".base-stem").evaluate((stem) => {
    const [from, to] = [0, 1].map((t) => (stem as SVGPathElement).getPointAtLength(t * (stem as SVGPathElement).getTotalLength()));
    const length = Math.hypot(to!.x - from!.x, to!.y - from!.y);
    return [(to!.x - from!.x) / length, (to!.y - from!.y) / length] as const;
  });
  const dragged = ([x, y]: Point, px: number): Point => [x + px * along[0], y + px * along[1]];
  const height = await knobAt("height");
  await user.stroke([height, dragged(height, 8)]);
  await grafted(user);
  expect((await base())?.height).toBeGreaterThan(heightBefore);
  const tilt = await knobAt("tilt");
  await user.stroke([tilt, dragged(tilt, 16)]);
  await grafted(user);
  expect((await base())?.tilt_deg).toBeGreaterThan(5);
  await user.rests();
  await user.screenshot("drop-closed-grips");
  await user.press("Control+z");
  await grafted(user);
  expect((await base())?.tilt_deg).toBe(5);
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  expect(await saved(harness)).toMatchObject(watertight);
  const found = await user.page.evaluate(() => window.meshgraft.editor.state.value?.steps.find(({ kind }) => kind === "merge")?.found);
  expect(found?.base_height).toBeGreaterThan(heightBefore); // Steps shows it, and changes it from there
  expect(user.complaints).toEqual([]);
}, 240_000);

// Drops the head onto the middle of the model.
async function dropHead(user: User): Promise<void> {
  const { page } = user;
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.rests();
  await page.evaluate(async () => {
    const { graft } = window.meshgraft.editor;
    await graft.beginDrop(() => graft.addPart({ sample: "head", resolution: 20 }, false));
  });
  const [left, top, right, bottom] = await boxOnPage(user, "model");
  const at: Point = [(left + right) / 2, (top + bottom) / 2];
  await page.mouse.move(...at, { steps: 4 });
  await user.clickAt(at);
  await grafted(user);
}

test("cancelling the graft of a dropped part removes the part, too, in one change, after undo as well", async () => {
  const { harness, user } = await open();
  await harness.openSample("bar", 20);
  const { page } = user;
  await dropHead(user);
  const changes = () => page.evaluate(() => [window.meshgraft.editor.state.value?.undo, window.meshgraft.editor.state.value?.redo]);
  const partsAre = (count: number) =>
    page.waitForFunction((count) => window.meshgraft.editor.graft.parts.value.length === count && window.meshgraft.editor.isIdle(), count);
  const cancel = async () => {
    await page.locator(".graft-end").getByRole("button", { name: "Cancel" }).click();
    await partsAre(0);
    expect(await graftOf(user)).toBeNull();
    expect(await page.getByRole("list", { name: "Parts" }).count()).toBe(0);
  };
  expect(await changes()).toEqual(["drop_part", null]);
  await cancel();
  expect(await changes()).toEqual(["cancel_graft", null]);
  await user.press("Control+z");
  await grafted(user);
  await cancel();
  await user.press("Control+z");
  await grafted(user);
  await user.press("Control+z");
  await partsAre(0);
  expect(await changes()).toEqual([null, "drop_part"]);
  await user.press("Control+Shift+z");
  await grafted(user);
  expect(user.complaints).toEqual([]);
});

test("a dropped part is removed by Cancel after a reload", async () => {
  const { user } = await open({ models: { "bar.ply": ["bar", "--resolution", "20"] } });
  const { page } = user;
  await dropHead(user);
  await page.reload();
  await user.ready();
  await grafted(user);
  await page.locator(".graft-end").getByRole("button", { name: "Cancel" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.graft.parts.value.length === 0 && window.meshgraft.editor.isIdle());
  expect(await graftOf(user)).toBeNull();
  expect(user.complaints).toEqual([]);
});

test("a part that is over the surface when the page is reloaded is taken back, and cannot be redone", async () => {
  const { user } = await open({ models: { "bar.ply": ["bar", "--resolution", "20"] } });
  const { page } = user;
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.rests();
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "group", name: "all of it", select: "all" });
    await editor.graft.beginDrop(() => editor.graft.addPart({ sample: "head", resolution: 20 }, false));
  });
  const [left, top, right, bottom] = await boxOnPage(user, "model");
  await page.mouse.move((left + right) / 2, (top + bottom) / 2, { steps: 4 });
  await page.waitForFunction(() => window.meshgraft.editor.graft.preview.value !== null);
  await page.reload();
  await user.ready();
  await page.getByText("The page was reloaded").waitFor();
  await page.waitForFunction(() => {
    const { editor } = window.meshgraft;
    return editor.state.value?.undo === "group" && editor.isIdle();
  });
  const state = await page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state).toMatchObject({ parts: [], graft: null, redo: null });
  await page.reload();
  await user.ready();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.undo === "group");
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.redo)).toBeNull();
  expect(user.complaints).toEqual([]);
});
