// Grafts in the page for tests: documents with a part, their loops on the screen, and the saved result.
import { EditorHarness, run, type HarnessOptions, type Point, type User } from "./harness";

let harness: EditorHarness | undefined;

/** Ends what the test has opened. */
export async function close(): Promise<void> {
  await harness?.close();
  harness = undefined;
}

type Opened = { harness: EditorHarness; user: User };

export async function open(options: HarnessOptions = {}): Promise<Opened> {
  harness = await EditorHarness.open(options);
  return { harness, user: harness.user };
}

/** Opens two coarse samples in the mode Graft, the second as a part. */
export async function openWithPart(model: string, part: string, resolution: number, starts = false): Promise<Opened> {
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
export async function grafted(user: User) {
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

export async function saved(harness: EditorHarness): Promise<Info> {
  const file = harness.folder.file("saved.ply");
  await harness.user.page.evaluate(async (mesh) => {
    await window.meshgraft.editor.ask({ do: "save", mesh, overwrite: true });
  }, file);
  return JSON.parse(run("info", file, "--json")) as Info;
}

export const watertight = { components: 1, loops: [], closed: true, manifold: true, oriented: true };

/** Returns the screen point of a vertex of the model or of a part. */
export function screenPointOf(user: User, mesh: number, vertex: number): Promise<Point> {
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
export async function hoverOverLoop(user: User, mesh: number, loop: number): Promise<Point> {
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
export function screenPointOnLoop(user: User, mesh: number, loop: number): Promise<Point> {
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

export const graftOf = (user: User) => user.page.evaluate(() => window.meshgraft.editor.state.value?.graft?.step ?? null);
