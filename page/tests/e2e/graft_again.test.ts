import { afterEach, expect, test } from "vitest";
import { close, grafted, graftOf, openWithPart, screenPointOf } from "./grafting";
import type { User } from "./harness";

afterEach(close);

const stepsOf = (user: User) => user.page.evaluate(() => window.meshgraft.editor.state.value?.steps ?? []);

async function openSteps(user: User): Promise<void> {
  await user.page.getByRole("tab", { name: "Deform" }).click();
  if ((await user.page.getByRole("list", { name: "Steps" }).count()) === 0) await user.page.getByText("Steps", { exact: true }).click();
}

/** A head on a bust, cut by a plane, with the shape of its crown changed. */
async function withLaterSteps(): Promise<User> {
  const { user } = await openWithPart("bust", "head", 24, true);
  const { page } = user;
  await grafted(user);
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const { low, high } = editor.box.value!;
    const below = low[2] + 0.1 * (high[2] - low[2]);
    await editor.ask({ do: "cut", plane: { point: [0, 0, below], normal: [0, 0, 1] }, keep: "above" });
    await editor.ask({ do: "sculpt", action: "inflate", height: 0.01, select: { indices: [0, 1, 2, 3] } });
  });
  return user;
}

test("an earlier graft is edited again with the later steps set aside, and they follow it", async () => {
  const user = await withLaterSteps();
  const { page } = user;
  const before = await stepsOf(user);
  const toolOf = (name: string) => page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name, exact: true });
  await page.getByRole("tab", { name: "Deform" }).click();
  await toolOf("Handle").click();
  await openSteps(user);
  await page.getByText("1. Graft: head on bust").click();
  await user.click("Edit pairs and placement…");
  await grafted(user);
  await openSteps(user);
  expect(await page.locator(".steps .set-aside").allInnerTexts()).toEqual([
    expect.stringContaining("2. Cut: bust"),
    expect.stringContaining("3. Shape: bust"),
  ]);
  for (const name of ["Handle", "Lay flat"]) expect(await toolOf(name).isDisabled()).toBe(true);
  expect(await toolOf("Navigate").getAttribute("aria-pressed")).toBe("true");
  await user.press("a"); // selects all, which nothing may be made of
  expect(await page.getByRole("button", { name: "Make handle" }).isDisabled()).toBe(true);
  await user.rests();
  await user.screenshot("steps-set-aside");
  await user.click("Show the graft");
  await page.getByText(/^2 later steps are set aside/).waitFor();
  await page.getByText("Manual", { exact: true }).click();
  await grafted(user);
  await user.rests();
  await user.screenshot("graft-earlier-again");
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  const after = await stepsOf(user);
  expect(after.map(({ kind }) => kind)).toEqual(before.map(({ kind }) => kind));
  expect(after[0]?.fields).toMatchObject({ pose: "keep" });
  expect(after[1]?.fields).toEqual(before[1]?.fields);
  await user.rests();
  await user.screenshot("graft-earlier-accepted");
  expect(user.complaints).toEqual([]);
}, 180_000);

test("a later step that no longer applies is named, and Cancel brings everything back", async () => {
  const user = await withLaterSteps();
  const { page } = user;
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const { low, high } = editor.box.value!;
    const above = high[2] - 0.1 * (high[2] - low[2]);
    await editor.ask({ do: "step", what: "change", index: 1, fields: { plane: { point: [0, 0, above], normal: [0, 0, 1] } } });
  });
  const before = await stepsOf(user);
  await openSteps(user);
  await page.getByText("1. Graft: head on bust").click();
  await user.click("Edit pairs and placement…");
  await grafted(user);
  await page.evaluate(async () => void (await window.meshgraft.editor.graft.set({ size: 0.05 })));
  await grafted(user);
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await page.getByText(/“2\. Cut: bust” no longer applies to the edited graft/).waitFor();
  expect(await graftOf(user)).not.toBeNull();
  await user.rests();
  await user.screenshot("graft-earlier-refused");
  await page.locator(".graft-end").getByRole("button", { name: "Cancel" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  expect(await stepsOf(user)).toEqual(before);
}, 180_000);

/** Takes up the first graft of the steps again. */
async function editFirstGraft(user: User): Promise<void> {
  await openSteps(user);
  if ((await user.page.getByText("Edit pairs and placement…").count()) === 0) await user.page.getByText(/^1\. Graft: /).click();
  await user.click("Edit pairs and placement…");
  await grafted(user);
}

/** Accepts the graft, and returns the fields of its step. */
async function acceptedFields(user: User): Promise<object | undefined> {
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  return (await stepsOf(user))[0]?.fields;
}

test("the start of an earlier graft is changed, and an area of its part is fixed by painting", async () => {
  const user = await withLaterSteps();
  const { page } = user;
  const before = await stepsOf(user);
  await editFirstGraft(user);
  const rotations = page.getByRole("group", { name: "Rotations of pair 1" }).getByRole("button");
  await rotations.nth(1).click();
  await grafted(user);
  const turned = (await acceptedFields(user)) as { pairs?: { matches?: unknown[] }[] };
  expect(turned.pairs?.[0]).not.toEqual((before[0]?.fields as typeof turned).pairs?.[0]);
  expect((await stepsOf(user)).map(({ kind }) => kind)).toEqual(before.map(({ kind }) => kind));

  await editFirstGraft(user);
  await page.getByText("Manual", { exact: true }).click();
  await grafted(user);
  await user.click("Paint fixed area");
  await page.waitForFunction(() => window.meshgraft.editor.graft.paintsFixed.value);
  await user.rests();
  const [mesh, top] = await page.evaluate(() => {
    const { editor, viewport } = window.meshgraft;
    const mesh = editor.graft.source.value!.mesh;
    const rest = viewport.surfaceOf(mesh)!.rest;
    let top = 0;
    for (let v = 0; v < rest.length / 3; ++v) if (rest[3 * v + 2]! > rest[3 * top + 2]!) top = v;
    return [mesh, top] as const;
  });
  const [x, y] = await screenPointOf(user, mesh, top);
  await user.stroke([[x, y + 8], [x + 6, y + 12]]);
  await page.waitForFunction(() => window.meshgraft.editor.graft.kept.value?.hasFixed === true);
  await user.screenshot("graft-earlier-painted");
  await user.click("Done painting");
  await grafted(user);
  expect(await acceptedFields(user)).toMatchObject({ pose: "keep", fixed: expect.anything() });
  expect(user.complaints).toEqual([]);
}, 180_000);

test("pairs of an earlier graft are removed and made again", async () => {
  const { user } = await openWithPart("posts", "bracket", 24);
  const { page } = user;
  await page.evaluate(async () => {
    const { graft, state } = window.meshgraft.editor;
    const [model, part] = [state.value!.model, state.value!.parts[0]!];
    const centreOf = (mesh: number, loop: number) => {
      const at = [0, 0];
      const { vertices } = graft.loops.value.get(mesh)![loop]!;
      const rest = window.meshgraft.viewport.surfaceOf(mesh)!.rest;
      for (const v of vertices) for (const k of [0, 1]) at[k]! += rest[3 * v + k]! / vertices.length;
      return at;
    };
    for (let loop = 0; loop < part.loops; ++loop) {
      const [x = 0, y = 0] = centreOf(part.mesh, loop);
      const far = (other: number) => Math.hypot(centreOf(model.mesh, other)[0]! - x, centreOf(model.mesh, other)[1]! - y);
      const [nearest = 0] = [...Array(model.loops).keys()].sort((a, b) => far(a) - far(b));
      await graft.pair({ mesh: model.mesh, loop: nearest }, { mesh: part.mesh, loop });
    }
  });
  await grafted(user);
  expect(await page.evaluate(() => window.meshgraft.editor.graft.arrangement.value)).toBe("result");
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await page.evaluate(() => window.meshgraft.editor.ask({ do: "sculpt", action: "inflate", height: 0.01, select: { indices: [0, 1, 2, 3] } }).then(() => undefined));
  const pairsOf = (fields: unknown) => (fields as { pairs?: object[] } | undefined)?.pairs?.length;
  expect(pairsOf((await stepsOf(user))[0]?.fields)).toBe(4);

  await editFirstGraft(user);
  await user.click("Remove pair 4");
  await grafted(user);
  await page.getByText("Up to 1 more pair can be made.").waitFor();
  await user.rests();
  await user.screenshot("graft-earlier-pairs");
  expect(pairsOf(await acceptedFields(user))).toBe(3);
  expect(user.complaints).toEqual([]);
}, 180_000);
