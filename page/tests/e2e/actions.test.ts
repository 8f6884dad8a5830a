// Counts every click, stroke and key from a fresh page on, opening included.
import { writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { close, grafted, open, saved, watertight } from "./grafting";
import { aimAt, farthest, gripOf, poseOf, sampled } from "./grips";
import { run, type EditorHarness, type Point, type User } from "./harness";

afterEach(close);

/** Opens a sample by a click on its card. */
async function openCard({ user }: { user: User }, name: RegExp): Promise<void> {
  await user.click(name);
  await user.opened();
}

async function held({ user }: { user: User }): Promise<void> {
  await user.page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
}

/** Chooses a tab of the panels. */
async function tab({ user }: { user: User }, name: string): Promise<void> {
  ++user.actions;
  await user.page.getByRole("tab", { name }).click();
}

async function accept({ user }: { user: User }): Promise<void> {
  ++user.actions;
  await user.page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
}

async function after(actions: number, { user }: { user: User }): Promise<void> {
  expect(user.actions).toBe(actions);
  expect(await user.page.getByRole("alert").count()).toBe(0);
  expect(user.complaints).toEqual([]);
}

test("a nose is made bigger in five actions", async () => {
  const opened = await open();
  const { harness, user } = opened;
  await openCard(opened, /^head/);
  await user.press("Numpad1"); // from the front
  await user.rests();
  const nose = await user.screenOf(farthest(sampled(harness, "head"), [0, -1, 0]));
  await user.press("h");
  await user.stroke([nose, [nose[0] + 8, nose[1] + 12]]);
  await held(opened);
  const knob = await gripOf(user, "knob");
  await user.stroke([knob, [knob[0] + 50, knob[1] - 50]]);
  await user.settle();
  expect(JSON.stringify((await poseOf(user))?.scale)).toMatch(/1\.[2-9]|[2-9]\./);
  await after(5, opened);
});

test("an arm is moved and bent in five actions", async () => {
  const opened = await open();
  const { harness, user } = opened;
  await openCard(opened, /^octopus/);
  const at = await aimAt(user, farthest(sampled(harness, "octopus"), [1, -0.3, 0]));
  await user.press("h");
  await user.stroke([at, [at[0] - 6, at[1] + 4]]);
  await held(opened);
  const ball = await gripOf(user, "ball");
  await user.stroke([ball, [ball[0] + 20, ball[1] - 90]]);
  const ring = await gripOf(user, "view-ring");
  await user.stroke([ring, [ring[0] + 40, ring[1] + 30]]);
  await user.settle();
  const pose = await poseOf(user);
  expect(pose?.translate).toBeDefined();
  expect(Math.abs(pose?.rotate?.angle_deg ?? 0)).toBeGreaterThan(5);
  await after(5, opened);
});

test("a head is grafted on a bust in four actions", async () => {
  const opened = await open();
  await openCard(opened, /^bust/);
  await tab(opened, "Graft");
  await opened.user.click("Add head");
  expect((await grafted(opened.user))?.error).toBeUndefined();
  await accept(opened);
  await after(4, opened);
  expect(await saved(opened.harness)).toMatchObject({ ...watertight, euler_characteristic: 2 });
});

/** Writes a closed cone, the point up. */
function writeHorn(file: string): void {
  const [sides, rings] = [24, 8];
  const lines = ["v 0 0 0"];
  for (let ring = 0; ring < rings; ++ring)
    for (let k = 0; k < sides; ++k) {
      const [radius, angle] = [0.12 * (1 - ring / rings), (2 * Math.PI * k) / sides];
      lines.push(`v ${radius * Math.cos(angle)} ${radius * Math.sin(angle)} ${(0.5 * ring) / rings}`);
    }
  lines.push("v 0 0 0.5");
  const at = (ring: number, k: number) => 2 + ring * sides + (k % sides);
  for (let k = 0; k < sides; ++k) {
    lines.push(`f 1 ${at(0, k + 1)} ${at(0, k)}`);
    for (let ring = 0; ring + 1 < rings; ++ring)
      lines.push(`f ${at(ring, k)} ${at(ring, k + 1)} ${at(ring + 1, k + 1)}`, `f ${at(ring, k)} ${at(ring + 1, k + 1)} ${at(ring + 1, k)}`);
    lines.push(`f ${at(rings - 1, k)} ${at(rings - 1, k + 1)} ${2 + rings * sides}`);
  }
  writeFileSync(file, `${lines.join("\n")}\n`);
}

/** Writes the sample head with its neck closed. */
function writeClosedHead({ folder }: EditorHarness): void {
  const made = folder.file("open.ply");
  run("sample", "head", "--resolution", "60", "-o", made);
  run("repair", made, "-o", folder.file("closed head.ply"), "--fill-holes", "1000");
}

test("a closed horn is grafted on a closed head in five actions", async () => {
  const opened = await open({ dark: true });
  const { harness, user } = opened;
  const { page } = user;
  writeClosedHead(harness);
  writeHorn(harness.folder.file("horn.obj"));
  await page.reload(); // the start screen lists the files
  await user.ready();
  await openCard(opened, /^closed head/);
  await tab(opened, "Graft");
  await page.evaluate(() => document.querySelector<HTMLSelectElement>('[aria-label="Where parts come from"]')?.scrollIntoView());
  ++user.actions;
  await page.getByRole("combobox", { name: "Where parts come from" }).selectOption({ index: 1 });
  const horn = await page.getByRole("button", { name: "Add horn" }).boundingBox();
  if (horn === null) throw new Error("the folder's horn is not in the library");
  await user.rests();
  const top = await page.evaluate((): Point => {
    const { viewport } = window.meshgraft;
    const { left, top, width, height } = viewport.canvas.getBoundingClientRect();
    return [left + 0.5 * width, top + 0.4 * height];
  });
  await user.stroke([[horn.x + 30, horn.y + 30], [top[0] + 20, top[1] + 20], top]);
  expect((await grafted(user))?.error).toBeUndefined();
  await user.rests();
  await user.screenshot("actions-horn");
  await accept(opened);
  await after(5, opened);
  expect(await saved(harness)).toMatchObject({ ...watertight, euler_characteristic: 2 });
});
