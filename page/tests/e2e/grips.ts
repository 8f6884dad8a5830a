// Finds the gizmo's parts on the page, and reads the document and the model. Runs without Vitest, too, in benchmarks.
import type { Pose } from "../../src/protocol";
import { positionsOf, putSample, type EditorHarness, type Point, type User } from "./harness";

/**
 * Opens the file of a built-in model, and discards what an earlier test left on it. The file is quicker than the model
 * itself, which the engine would compute each time.
 */
export async function openFresh(harness: EditorHarness, sample: string, resolution?: number): Promise<void> {
  await harness.openFile(fileOf(harness, sample, resolution));
  await harness.user.page.evaluate(async () => {
    const { editor } = window.meshgraft;
    if (editor.offer.value === null) return;
    await editor.ask({ do: "discard" });
    editor.offer.value = null;
  });
  await harness.user.rests();
}

/** Returns the rest positions of a built-in model. */
export function sampled(harness: EditorHarness, name: string, resolution?: number): Float64Array {
  return positionsOf(fileOf(harness, name, resolution));
}

/** Returns the file of a built-in model. */
function fileOf(harness: EditorHarness, name: string, resolution?: number): string {
  const file = harness.folder.file(`${name}.obj`);
  putSample([name, ...(resolution === undefined ? [] : ["--resolution", String(resolution)])], file);
  return file;
}

/** Returns a screen point where a part of the gizmo can be dragged: "knob", "ring-z", "arrow-x" … */
export async function gripOf(user: User, part: string): Promise<Point> {
  const selector = `.gizmo:not([display]) > [data-part="${part}"]:not([display])`;
  await user.page.evaluate(
    () => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))),
  );
  await user.page.waitForSelector(selector, { state: "attached" });
  return user.page.evaluate((id) => {
    const line = document.querySelector<SVGPathElement>(`[data-part="${id}"] .line`);
    const map = line?.getScreenCTM();
    if (line === null || map === null || map === undefined) throw new Error(`no ${id}`);
    const share = id.startsWith("ring")
      ? 0.5
      : id === "view-ring"
        ? 0.3
        : id.startsWith("arrow")
          ? 0.45
          : undefined;
    if (share !== undefined) {
      const at = line.getPointAtLength(share * line.getTotalLength()).matrixTransform(map);
      return [at.x, at.y] as const;
    }
    const box = line.getBBox();
    const middle = new DOMPoint(box.x + box.width / 2, box.y + box.height / 2).matrixTransform(map);
    return [middle.x, middle.y] as const;
  }, part);
}

async function aimOnce(user: User, vertex: number): Promise<Point | undefined> {
  const [x, y] = await user.screenOf(vertex);
  return user.page.evaluate(
    ([x, y]) => {
      const { viewport } = window.meshgraft;
      const isOn = (dx: number, dy: number) => viewport.pick(x + dx, y + dy) !== undefined;
      for (let radius = 0; radius <= 40; radius += 4)
        for (let k = 0; k < 16; ++k) {
          const [dx, dy] = [radius * Math.cos((k * Math.PI) / 8), radius * Math.sin((k * Math.PI) / 8)];
          if (isOn(dx, dy) && isOn(dx - 5, dy) && isOn(dx + 5, dy) && isOn(dx, dy + 5) && isOn(dx, dy - 5))
            return [x + dx, y + dy] as const;
        }
      return undefined;
    },
    [x, y] as const,
  );
}

/** Returns a screen point near a vertex, with the model all around it, where a user would aim. */
export async function aimAt(user: User, vertex: number): Promise<Point> {
  const last = Date.now() + 5000; // a worker builds the tree for picking
  for (;;) {
    const at = await aimOnce(user, vertex);
    if (at !== undefined) return at;
    if (Date.now() > last) throw new Error(`vertex ${vertex} is not seen`);
    await user.page.waitForTimeout(50);
  }
}

export function poseOf(user: User, handle = "handle 1"): Promise<Pose | undefined> {
  return user.page.evaluate(
    (name) => window.meshgraft.editor.state.value?.handles.find((known) => known.name === name)?.pose,
    handle,
  );
}

/** Returns the vertices of a handle, as the engine reports them. */
export function verticesOf(user: User, handle = "handle 1"): Promise<number[]> {
  return user.page.evaluate(
    (name) => [...(window.meshgraft.viewport.main?.handles.get(name) ?? [])],
    handle,
  );
}

export function selectedIn(user: User): Promise<number[]> {
  return user.page.evaluate(() => {
    const found: number[] = [];
    window.meshgraft.viewport.main?.selection.forEach((is, v) => is !== 0 && found.push(v));
    return found;
  });
}

/** Returns the vertex farthest along a direction. */
export function farthest(positions: Float64Array, along: readonly [number, number, number]): number {
  let best = 0;
  let most = -Infinity;
  for (let v = 0; 3 * v < positions.length; ++v) {
    const far = along.reduce((sum, part, k) => sum + part * (positions[3 * v + k] as number), 0);
    if (far > most) [best, most] = [v, far];
  }
  return best;
}

export function positionOf(positions: Float64Array, v: number): [number, number, number] {
  return [positions[3 * v] as number, positions[3 * v + 1] as number, positions[3 * v + 2] as number];
}

export function centreOf(positions: Float64Array, vertices: readonly number[]): [number, number, number] {
  const sum: [number, number, number] = [0, 0, 0];
  for (const v of vertices)
    positionOf(positions, v).forEach((part, k) => (sum[k] = (sum[k] as number) + part / vertices.length));
  return sum;
}

export function distance(a: readonly number[], b: readonly number[]): number {
  return Math.hypot(...a.map((part, k) => part - (b[k] as number)));
}

/** Returns the mean distance of vertices from their centre. */
export function sizeOf(positions: Float64Array, vertices: readonly number[]): number {
  const centre = centreOf(positions, vertices);
  return vertices.reduce((sum, v) => sum + distance(positionOf(positions, v), centre), 0) / vertices.length;
}

/** Exports the mesh by the dialog, and returns the path of the file. */
export async function exported(harness: EditorHarness, name: string, extension = ".ply"): Promise<string> {
  const { page } = harness.user;
  await harness.user.press("Control+e");
  await page.getByLabel("Format").selectOption(extension);
  await page.getByRole("dialog").getByRole("textbox").fill(name);
  await page.getByRole("dialog").getByRole("button", { name: "Export", exact: true }).click();
  await page.getByText("Exported", { exact: true }).waitFor({ timeout: 20_000 });
  await harness.user.click("Close the message");
  return harness.folder.file(`${name}${extension}`);
}
