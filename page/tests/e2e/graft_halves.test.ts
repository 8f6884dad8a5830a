import { afterEach, expect, test } from "vitest";
import { close, open } from "./grafting";
import { run } from "./harness";

afterEach(close);

interface Info {
  mesh: string;
  closed: boolean;
  components: number;
}

test("a split keeps two objects, and each is hidden, exported and made the model by itself", async () => {
  const { harness, user } = await open();
  const { page } = user;
  const names = () =>
    page.evaluate(() => {
      const { model, parts } = window.meshgraft.editor.state.value!;
      return [model.name, ...parts.map(({ name }) => name)];
    });
  const shown = () => page.evaluate(() => window.meshgraft.viewport.parts.shown().length);
  await harness.openSample("bar", 16);
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Cut by a plane");
  await page.getByRole("button", { name: "Across Z" }).click();
  const panel = page.locator(".cut-in-work");
  await panel.getByText("Pins", { exact: true }).click();
  await user.click("Split, keep both");
  await page.getByText("Split into bar (blue side) and bar 2 (red side)").waitFor();
  await user.rests();
  expect(await names()).toEqual(["bar", "bar 2"]);
  expect(await shown()).toBe(1);
  await user.screenshot("cut-halves");

  const export_ = async (object: string | undefined, file: string): Promise<Info> => {
    const dialog = page.getByRole("dialog");
    if (object !== undefined) await dialog.getByRole("combobox", { name: "Object" }).selectOption({ label: object });
    await dialog.getByRole("textbox", { name: "Name" }).fill(file);
    await user.screenshot(`cut-halves-export-${file}`);
    await dialog.getByRole("button", { name: "Export", exact: true }).click();
    await dialog.waitFor({ state: "detached" });
    return JSON.parse(run("info", harness.folder.file(`${file}.ply`), "--json")) as Info;
  };
  await user.press("Control+e");
  const above = await export_(undefined, "above");
  await user.click("More for bar 2");
  await page.getByRole("menuitem", { name: "Export…" }).click();
  const below = await export_(undefined, "below");
  await user.press("Control+e");
  expect(await export_("bar 2", "again")).toEqual({ ...below, mesh: harness.folder.file("again.ply") });
  for (const half of [above, below]) expect(half).toMatchObject({ closed: true, components: 1 });

  await user.click("Hide bar 2");
  expect(await shown()).toBe(0);
  await user.click("Show bar 2");
  await user.click("More for bar 2");
  await page.getByRole("menuitem", { name: "Make it the model" }).click();
  await user.settle();
  expect(await names()).toEqual(["bar 2", "bar"]);
  await page.getByRole("button", { name: "Steps" }).first().click();
  await page.getByText("1. Cut: bar, gives bar 2").waitFor();
  await page.getByText("1. Cut: bar, gives bar 2").click();
  expect(await page.getByRole("radiogroup", { name: "Keep" }).innerText()).not.toContain("Both");
  await user.screenshot("cut-halves-steps");
  await user.press("Control+z");
  await user.press("Control+z");
  await user.settle();
  expect(await names()).toEqual(["bar"]);
  expect(user.complaints).toEqual([]);
}, 240_000);

test("a closed curve that divides nothing opens the surface", async () => {
  const { harness, user } = await open();
  const { page } = user;
  await harness.openSample("torus", 24);
  const loop = await page.evaluate(() => {
    const { positions, offset, vertexCount } = window.meshgraft.viewport.main!;
    const at = (v: number, k: number) => (positions[3 * v + k] ?? 0) + (offset[k] ?? 0);
    // Vertices around the tube where it crosses the half plane y = 0, x > 0.
    const near = Array.from({ length: vertexCount }, (_, v) => v).filter((v) => at(v, 0) > 0);
    const mean = near.filter((v) => Math.abs(at(v, 1)) < 0.05).reduce((sum, v, _, all) => sum + at(v, 0) / all.length, 0);
    const wanted = [0, 1, 2, 3].map((k) => [Math.cos((k * Math.PI) / 2), Math.sin((k * Math.PI) / 2)] as const);
    return wanted.map(([c, s]) => {
      const score = (v: number) => c * (at(v, 0) - mean) + s * at(v, 2) - 5 * Math.abs(at(v, 1));
      return near.reduce((best, v) => (score(v) > score(best) ? v : best));
    });
  });
  const done = await page.evaluate(
    async ([a, b, c, ...rest]) => window.meshgraft.editor.ask({ do: "cut", halves: true, loop: [a!, b!, c!, ...rest] }),
    loop,
  );
  expect(done?.name).toBeUndefined();
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.model.loops)).toBe(2);
  expect(user.complaints).toEqual([]);
});
