import { afterAll, beforeAll, expect, test } from "vitest";
import { aimAt, distance, exported, farthest, gripOf, positionOf, verticesOf } from "./grips";
import { EditorHarness, positionsOf } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open({ models: { "ring.obj": ["torus", "--resolution", "60"] } });
});
afterAll(() => harness.close());

/** A grid of cubes over positions, to find the nearest one. */
class Cubes {
  private readonly cubes = new Map<string, number[]>();
  constructor(
    private readonly positions: Float64Array,
    private readonly size: number,
  ) {
    for (let v = 0; 3 * v < positions.length; ++v) {
      const key = this.keyOf(positionOf(positions, v));
      this.cubes.set(key, [...(this.cubes.get(key) ?? []), v]);
    }
  }
  private keyOf(position: readonly number[]): string {
    return position.map((x) => Math.floor(x / this.size)).join(" ");
  }
  /** Returns the distance from a point to the nearest position; infinite beyond the size of a cube. */
  nearest([x, y, z]: readonly [number, number, number]): number {
    let least = Infinity;
    const steps = [-this.size, 0, this.size];
    for (const dx of steps)
      for (const dy of steps)
        for (const dz of steps)
          for (const v of this.cubes.get(this.keyOf([x + dx, y + dy, z + dz])) ?? [])
            least = Math.min(least, distance([x, y, z], positionOf(this.positions, v)));
    return least;
  }
}

function diagonalOf(positions: Float64Array): number {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3] as number, x);
    high[i % 3] = Math.max(high[i % 3] as number, x);
  });
  return distance(low, high);
}

/** Returns the distance of a mesh from its mirror image across y = 0, × the diagonal of its box. */
function asymmetry(positions: Float64Array): number {
  const diagonal = diagonalOf(positions);
  const cubes = new Cubes(positions, 1e-3 * diagonal);
  let most = 0;
  for (let v = 0; 3 * v < positions.length; ++v) {
    const [x, y, z] = positionOf(positions, v);
    most = Math.max(most, cubes.nearest([x, -y, z]) / diagonal);
  }
  return most;
}

test("what is done on one side of the plane happens on the other, to a millionth", async () => {
  const { user, folder } = harness;
  const { page } = user;
  const rest = positionsOf(folder.file("ring.obj"));
  expect(asymmetry(rest)).toBeLessThan(1e-6);

  await page
    .locator(".side")
    .getByRole("button", { name: /^Symmetry/ })
    .first()
    .click();
  await page.getByRole("switch", { name: "Symmetric editing" }).check();
  await page
    .locator(".section")
    .filter({ hasText: "Symmetric editing" })
    .getByText("Y", { exact: true })
    .click();
  await page.waitForFunction(
    () => Math.abs(window.meshgraft.editor.state.value?.symmetry?.plane.normal[1] ?? 0) === 1,
  );
  await user.settle();

  await user.rests();
  await user.screenshot("symmetry-plane");

  await user.press("Numpad7"); // from above: both sides are seen
  await user.rests();
  const at = await aimAt(user, farthest(rest, [0.3, 0.6, 1]));
  await user.press("h");
  await user.stroke([at, [at[0] + 14, at[1] + 4]]);
  await page.waitForFunction(() => window.meshgraft.editor.tools.activeHandle.value !== null);
  await user.settle();
  await page.getByText(/^Mirrored: handle 1/).waitFor();
  const name = await page.evaluate(() => window.meshgraft.editor.tools.activeHandle.value ?? "");
  const held = await verticesOf(user, name);
  expect(held.every((v) => (rest[3 * v + 1] as number) > 0)).toBe(true);

  const ball = await gripOf(user, "ball");
  await user.stroke([ball, [ball[0] + 40, ball[1] - 60]]);
  await user.settle();
  for (const key of ["r", "x", "4", "0", "Enter"]) await user.press(key);
  await user.settle();
  await user.screenshot("symmetry-moved");

  const file = await exported(harness, "both sides", ".obj");
  const bent = positionsOf(file);
  const diagonal = diagonalOf(bent);
  const moved = Array.from(
    { length: rest.length / 3 },
    (_, v) => distance(positionOf(rest, v), positionOf(bent, v)) / diagonal,
  );
  const far = (side: 1 | -1) => Math.max(...moved.filter((_, v) => side * (rest[3 * v + 1] as number) > 0.1));
  expect(far(1)).toBeGreaterThan(0.05);
  expect(far(-1)).toBeCloseTo(far(1), 6);
  expect(asymmetry(bent)).toBeLessThan(1e-6);
  expect(user.complaints).toEqual([]);
});

test("a refusal names the tolerance that would do, and takes it by a click", async () => {
  const { user } = harness;
  const { page } = user;
  await harness.openSample("octopus", 30);
  const tolerance = page.locator(".section").filter({ hasText: "Symmetric editing" }).getByRole("textbox", { name: "Tolerance" });
  await tolerance.fill("0.0001"); // per cent; the field is there while symmetry is off, too
  await tolerance.press("Enter");
  await page.getByRole("switch", { name: "Symmetric editing" }).check();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry?.tolerance_rel === 1e-6);
  await page.evaluate(() =>
    window.meshgraft.editor
      .ask({ do: "handle", what: "add", name: "arm", select: { half_space: { point: [0.5, 0, 0], normal: [1, 0, 0] } }, reach: 0.2 })
      .then(() => undefined),
  );
  const told = page.getByRole("alert").filter({ hasText: "a mirror image" });
  await told.waitFor();
  await user.screenshot("symmetry-refused");
  expect(await told.textContent()).not.toContain("tolerance_rel");
  await told.getByRole("button", { name: /^Use [\d.]+ %$/ }).click();
  await page.waitForFunction(() => window.meshgraft.editor.isIdle());
  const { symmetry, handles } = (await page.evaluate(() => window.meshgraft.editor.state.value)) ?? {};
  expect(symmetry?.tolerance_rel).toBeGreaterThan(1e-6);
  expect([handles?.length, await page.getByRole("alert").count()]).toEqual([1, 0]);
});

test("the first plane lies between left and right, also of a model that faces sideways", async () => {
  const { user } = harness;
  const { page } = user;
  await harness.openSample("dinosaur", 40);
  await user.press("y");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.symmetry != null);
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.symmetry?.plane.normal)).toEqual([0, 1, 0]);
  expect(user.complaints).toEqual([]);
});
