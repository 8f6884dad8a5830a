import type { DocumentState, Vector } from "../../protocol";
import type { Viewport } from "../../view/viewport";
import type { Editor } from "../editor";
import { nearestAxis, planeAcross, type Plane } from "../mirror_plane";
import type { GraftFields } from "./graft_step";
import { mirroredGraft } from "./mirrored_graft";

type Step = DocumentState["steps"][number];
const noLoop = "the model has no open loop where the mirrored copy would be";

/** Returns the step of a graft that nothing follows. */
export function latestGraft(state: DocumentState | null): Step | undefined {
  const [graft, last] = state?.steps.slice(-2) ?? [];
  const isLatest = graft?.kind === "merge" && last?.kind === "deform" && last.handles === 0;
  return state?.graft === null && isLatest ? graft : undefined;
}

/** Returns the part that was grafted last, if nothing follows that. */
export function partToMirror(editor: Editor): string | undefined {
  return (latestGraft(editor.state.value)?.fields as GraftFields | undefined)?.source;
}

/** Grafts the part that was grafted last once more, as a mirror image at a plane. */
export async function mirrorLatestGraft(editor: Editor, viewport: Viewport): Promise<void> {
  const { graft } = editor;
  const step = latestGraft(editor.state.value);
  const surface = viewport.main;
  if (step === undefined || surface === undefined) return;
  const fields = wholeFields(step.fields, graft.latestStep.value);
  if (fields === undefined)
    return editor.note("the fixed areas of the graft are no longer known here", "", "Edit the graft again under Steps, accept it, then mirror it.", "steps");
  const { starts = [], start_places: places = [] } = step.found ?? {};
  const plane = mirrorPlane(editor, viewport, places);
  graft.mode.value = "graft";
  await graft.needLoops();
  const loopsOf = (mesh: number | undefined) => (graft.loops.value.get(mesh ?? -1) ?? []).map(({ curve }) => curve);
  const positionOf = (vertex: number) => surface.positionOf(vertex).toArray();
  const partLoops = loopsOf(graft.byName(fields.source ?? "")?.mesh);
  for (const { key, told } of editor.messages.value) if (told.problem === noLoop) editor.dismiss(key);
  const mirrored = mirroredGraft({ fields, starts, places, loops: loopsOf(surface.id), partLoops, positionOf }, plane);
  if (mirrored === undefined)
    return editor.note(
      noLoop,
      "",
      "Turn Symmetry on to choose the plane, or cut the model open there.",
      "symmetry",
    );
  graft.arrangement.value = "result";
  await graft.set(mirrored);
}

/**
 * The plane of symmetry, or else that between left and right through the middle of the model before the graft. The seam
 * replaces the rim of an open loop, so the places where the part met the loop are counted in.
 */
function mirrorPlane({ state, graft, box }: Editor, viewport: Viewport, places: readonly (Vector | null)[]): Plane {
  const symmetry = state.value?.symmetry?.plane;
  if (symmetry !== undefined) return symmetry;
  const axis = nearestAxis(viewport.navigation.axes()[1].toArray());
  const before = graft.seam.value?.target ?? box.value ?? { low: [0, 0, 0], high: [0, 0, 0] };
  const points = [before.low, before.high, ...places.filter((place) => place !== null)];
  const bound = (of: (...values: number[]) => number) => [0, 1, 2].map((k) => of(...points.map((point) => point[k] as number))) as Vector;
  return planeAcross(axis, { low: bound(Math.min), high: bound(Math.max) });
}

// The state has long lists as their number of elements; the step that was edited last has them all.
function wholeFields(fields: GraftFields, latest: GraftFields | null): GraftFields | undefined {
  const { kind: _, name: __, result: ___, counts: ____, ...known } = fields as GraftFields & Record<string, unknown>;
  if (!JSON.stringify(known).includes('{"count":')) return known as GraftFields;
  const isSame = latest !== null && JSON.stringify([latest.source, latest.at, latest.pairs]) === JSON.stringify([known.source, known.at, known.pairs]);
  return isSame ? { ...(known as GraftFields), fixed: latest.fixed ?? null } : undefined;
}
