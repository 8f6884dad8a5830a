import { afterEach, expect, test } from "vitest";
import {
  close,
  grafted,
  graftOf,
  hoverOverLoop,
  openWithPart,
  saved,
  screenPointOf,
  screenPointOnLoop,
} from "./grafting";
import type { Point } from "./harness";

afterEach(close);

test("offers other rotations as pictures, which turn the part and are undone", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  const turnOf = async (report: Awaited<ReturnType<typeof grafted>>) => report?.transform?.[0]?.[0] ?? NaN;
  expect(await turnOf(await grafted(user))).toBeGreaterThan(0); // the head looks the way the bust does
  const rotations = user.page.getByRole("group", { name: "Rotations of pair 1" }).getByRole("button");
  expect(await rotations.first().getAttribute("aria-pressed")).toBe("true");
  const pictures = rotations.locator("img");
  await user.page.waitForFunction(
    (count) => document.querySelectorAll(".rotations img").length === count,
    await rotations.count(),
  );
  const sources = await pictures.evaluateAll((all) => all.map((one) => (one as HTMLImageElement).src));
  expect(new Set(sources).size).toBe(sources.length); // each shows another rotation
  expect(await rotations.first().innerText()).toContain("likeliest");
  await user.screenshot("graft-rotations");
  const back = rotations.filter({ hasText: /^-?1[78]\d°/ }).first();
  await back.click();
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.pairs.value[0]?.start !== undefined);
  expect(await turnOf(await grafted(user))).toBeLessThan(0);
  expect(await back.getAttribute("aria-pressed")).toBe("true");
  await user.rests();
  await user.screenshot("graft-rotated");
  await user.press("Control+z");
  await user.page.waitForFunction(() => window.meshgraft.editor.graft.pairs.value[0]?.start === undefined);
  expect(await turnOf(await grafted(user))).toBeGreaterThan(0);
  expect(await rotations.first().getAttribute("aria-pressed")).toBe("true");
  expect(user.complaints).toEqual([]);
});

test("shows how the seam bends, and the result's edges", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  const report = await grafted(user);
  await user.page.getByRole("button", { name: "View", exact: true }).click();
  await user.page.getByLabel("Heat map").selectOption("seam");
  const legend = user.page.locator(".view-legend");
  await legend.getByText("Bend angle at the seam").waitFor();
  await user.press("z");
  await user.rests();
  await user.screenshot("graft-seam-bends");
  const largest = Number(/([\d.]+)°$/.exec((await legend.textContent()) ?? "")?.[1]);
  expect(largest).toBeGreaterThan(0);
  expect(largest).toBeLessThan(4 * (report?.seam?.dihedral_p99_deg ?? 0));
  await user.page.getByRole("radio", { name: "Apart" }).or(user.page.getByText("Apart", { exact: true })).first().click();
  await user.rests();
  expect(await legend.getByText("Bend angle").isVisible()).toBe(false);

  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  await legend.getByText("Bend angle at the seam").waitFor();
  await user.rests();
  expect(Number(/([\d.]+)°$/.exec((await legend.textContent()) ?? "")?.[1])).toBeCloseTo(largest, 0);
  await user.screenshot("graft-seam-bends-accepted");

  // The seam is selected from the step, and smoothed.
  await user.page.getByRole("tab", { name: "Deform" }).click();
  if ((await user.page.getByRole("list", { name: "Steps" }).count()) === 0) await user.page.getByText("Steps", { exact: true }).click();
  await user.page.getByText("1. Graft: head on bust").click();
  await user.click("Select the seam");
  await user.page.getByText(/^\d+ vertices selected$/).waitFor();
  await user.page.getByRole("toolbar", { name: "Shape" }).getByRole("button", { name: "Smooth" }).click();
  await user.page.getByText("2. Shape").waitFor();
  await user.press("Control+z");
  await user.page.getByText("2. Shape").waitFor({ state: "detached" });
  await user.click("Relax the seam"); // both in one act
  await user.page.getByText("2. Shape").waitFor();
  expect(user.complaints).toEqual([]);
});

test("shows how the graft stretches the part, and nothing else", async () => {
  const { user } = await openWithPart("bust", "head", 40, true);
  await grafted(user);
  await user.page.getByRole("button", { name: "View", exact: true }).click();
  await user.page.getByLabel("Heat map").selectOption("stretch");
  await user.page.locator(".view-legend").getByText("Change of area").waitFor();
  await user.rests();
  await user.screenshot("graft-stretch");
  const most = await user.page.evaluate(() => {
    const { editor, viewport } = window.meshgraft;
    const message = editor.graft.preview.value;
    const heat = viewport.alsoShown()[0]?.[0].geometry.getAttribute("heat").array ?? new Float32Array();
    const triangles = message?.indices("triangles") ?? new Uint32Array();
    const origin = message?.bytes("origin") ?? new Uint8Array();
    const height = message?.floats("positions") ?? new Float32Array();
    const least = Math.min(...height.filter((_, i) => i % 3 === 2));
    const most = { foot: 0, part: 0 }; // largest stretch at the model's foot, and in the part
    triangles.forEach((v, corner) => {
      const from = origin[Math.floor(corner / 3)];
      const stretch = Math.abs(heat[v] ?? NaN);
      if (from === 1) most.part = Math.max(most.part, stretch);
      if (from === 0 && (height[3 * v + 2] ?? 0) < least + 0.1) most.foot = Math.max(most.foot, stretch);
    });
    return most;
  });
  expect(most.foot).toBe(0);
  expect(most.part).toBeGreaterThan(0.05);
  expect(most.part).toBeLessThan(4);
  expect(user.complaints).toEqual([]);
});

test("grafts in the document that is opened next, too, and shows no loops of the one before", async () => {
  const { harness, user } = await openWithPart("bust", "head", 20, true);
  await grafted(user);
  await harness.openSample("torus", 20);
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
  for (const [index, [target, source]] of pairs.entries()) {
    if (index > 0) await user.page.evaluate(() => (window.meshgraft.editor.graft.arrangement.value = "apart"));
    await user.rests();
    await user.clickAt(await hoverOverLoop(user, model, target));
    await user.page.waitForFunction(() => window.meshgraft.editor.graft.picked.value !== null);
    await user.clickAt(await screenPointOnLoop(user, part, source));
    await user.page.mouse.move(500, 700); // off the loops, so that the result is shown as soon as there is one
    await grafted(user);
  }
  expect(await user.page.evaluate(() => window.meshgraft.editor.graft.arrangement.value)).toBe("result");
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
  await slide("Tilt", 0.1);
  expect(await graftOf(user)).toMatchObject({ normal_angle_deg: expect.closeTo(18, -1) });
  const before = ((await graftOf(user)) as { normal_angle_deg: number }).normal_angle_deg;
  const angle = user.page.getByRole("slider", { name: "Tilt" });
  await angle.press("ArrowRight");
  await grafted(user);
  expect(await graftOf(user)).toMatchObject({ normal_angle_deg: Math.round(before) + 1 });
  const field = user.page.getByRole("textbox", { name: "Twist" });
  await field.fill("180");
  await field.press("Enter");
  await grafted(user);
  expect(await field.inputValue()).not.toMatch(/^[-−]/);
  await field.press("ArrowUp"); // a step beyond the range is refused with a message
  await user.page.getByRole("alert").getByText("-180 to 180").waitFor();
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
  await user.page.getByText("Bend", { exact: true }).click();
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
  await user.page.getByText("Manual", { exact: true }).click();
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
  await user.click("Paint fixed area");
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

test("the graft of an opened edit is accepted, and its step takes it up again", async () => {
  const { harness, user } = await openWithPart("bust", "head", 24, true);
  const { page } = user;
  await grafted(user);
  const edit = harness.folder.file("portrait.json");
  await page.evaluate(async (edit) => void (await window.meshgraft.editor.ask({ do: "save", edit })), edit);
  await harness.openFile(edit);
  expect(await graftOf(user)).toBeNull();
  await page.getByRole("tab", { name: "Deform" }).click();
  if ((await page.getByRole("list", { name: "Steps" }).count()) === 0) await page.getByText("Steps", { exact: true }).click();
  await page.getByText("1. Graft: head on bust").click();
  await user.screenshot("steps-graft-again");
  await user.click("Edit pairs and placement…");
  await grafted(user);
  await page.getByText("Manual", { exact: true }).click();
  await grafted(user);
  expect(await graftOf(user)).toMatchObject({ pose: "keep" });
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  expect(user.complaints).toEqual([]);
});
