import { computed, type ReadonlySignal } from "@preact/signals";
import type { Graft } from "./graft";
import type { LiveWords } from "../live_words";
import { forFingers } from "../pointer_kind";
import { counted } from "../units";
import { fieldsOf } from "../wording";

/** Returns what the user has to do before a graft can start; undefined without a part. */
export function pairingWords(graft: Graft): string | undefined {
  const words = nextAction(graft);
  return words === undefined ? undefined : forFingers(`${words}.`);
}

function nextAction(graft: Graft): string | undefined {
  const waiting = graft.parts.value.filter((part) => graft.isShown(part) && !(graft.isHalf(part) && part.loops === 0));
  if (waiting.length === 0) return undefined;
  const open = waiting.filter((part) => part.loops > 0);
  if (open.length === 0) return "The part is closed: drop it on the surface, or cut it open";
  if ((graft.model.value?.loops ?? 0) === 0)
    return "The model has no open boundary: cut it open, or drop the part on its surface";
  return graft.picked.value === null
    ? "Click a loop of the model and the loop of the part to join to it"
    : "Now click the loop of the other mesh to join to it";
}

/** Returns how many more pairs can be made: of loops of the part and of the model that have none. */
export function morePairs(graft: Graft): number {
  const loops = Math.min(graft.source.value?.loops ?? 0, graft.target.value?.loops ?? 0);
  return Math.max(0, loops - graft.pairs.value.length);
}

/** Returns whether the graft waits for another pair, because a piece of the part has none. */
export function needsPair(graft: Graft): boolean {
  const error = graft.report.value?.error;
  return error !== undefined && fieldsOf(error, "merge.component_without_pair") !== undefined;
}

/** Says how many pairs a graft that waits for one needs at least, and can have at most. */
export function pairsToGoWords(graft: Graft): string {
  const most = morePairs(graft);
  return most > 1 ? `1 more pair needed, up to ${most} possible` : "1 more pair to go";
}

/** Returns in few words what graft mode waits for. */
export function graftWords(graft: Graft): LiveWords {
  const idle = (text: string, explained = ""): LiveWords => ({ tone: "idle", text, explained });
  switch (graft.tool.value) {
    case "plane":
      return graft.cutPlane.value === null
        ? idle("No plane yet")
        : idle("Choose the side to keep");
    case "stroke":
      return graft.cutCurve.value?.closed === true
        ? idle("Choose the side to keep")
        : idle("No closed curve yet");
    case "drop":
      return idle(forFingers("Point at the surface; click or release to graft"));
    case "fixed":
      return idle("Painting the fixed area");
    case "loops":
      return graft.isEdited.value ? inGraft(graft, graft.pairs.value.length) : beforeGraft(graft);
  }
}

function beforeGraft(graft: Graft): LiveWords {
  // The panel says what to do once there is a part.
  const text = nextAction(graft) === undefined ? "Add a part from the library, or drag one onto the surface" : "Not grafted yet";
  return { tone: "idle", text, explained: "" };
}

function inGraft(graft: Graft, pairs: number): LiveWords {
  const { value: report } = graft.report;
  if (needsPair(graft)) return { tone: "idle", text: pairsToGoWords(graft), explained: "Each piece of the part needs a pair." };
  if (report?.error !== undefined) {
    return { tone: "problem", text: "Cannot be grafted", explained: "The panel Graft says why." };
  }
  if (pairs === 0 && graft.kept.value?.at === undefined)
    return { tone: "idle", text: "No loops paired yet", explained: "" };
  if (graft.preview.value === null || graft.dragged.value !== null)
    return { tone: "busy", text: "Grafting…", explained: "A preview follows in a moment." };
  const open = pairs > 0 ? (graft.source.value?.loops ?? 0) - pairs : 0;
  const more = pairs > 0 ? morePairs(graft) : 0;
  if (more > 0)
    return { tone: "good", text: `Grafted; up to ${counted(more, "more pair")}`, explained: "Pair further loops, or Accept to leave them open." };
  if (open > 0)
    return { tone: "good", text: `Grafted; ${counted(open, "loop")} of the part not joined`, explained: "Pair them too, or Accept to leave them open." };
  return { tone: "good", text: "Grafted; Accept to finish", explained: "You can still change it. The view shows the result." };
}

/** The size of the shown objects. */
export interface ShownSize {
  vertices: number;
  faces: number;
  /** Side lengths of the bounding box, if one object is shown. */
  sides: readonly number[] | undefined;
}

/**
 * Computes the size of what graft mode shows: the result if there is one, and the objects beside it. `sidesOf` returns
 * the side lengths of a mesh's box.
 */
export function shownSize(graft: Graft, sidesOf: (mesh: number) => readonly number[] | undefined): ReadonlySignal<ShownSize> {
  const ofPreview = computed(() => sizeOf(graft.preview.value));
  return computed(() => {
    const objects = graft.objects.value.filter((object) => graft.shownMeshes.value.has(object.mesh));
    const isPreviewed = graft.preview.value !== null && graft.arrangement.value !== "apart";
    const result = isPreviewed ? ofPreview.value : undefined;
    const sum = (of: (object: { vertices: number; faces: number }) => number) =>
      [...objects, ...(result === undefined ? [] : [result])].reduce((all, object) => all + of(object), 0);
    const [only] = objects;
    const alone = result !== undefined ? (only === undefined ? result.sides : undefined) : objects.length === 1 && only !== undefined ? sidesOf(only.mesh) : undefined;
    return { vertices: sum((object) => object.vertices), faces: sum((object) => object.faces), sides: alone };
  });
}

function sizeOf(frame: Graft["preview"]["value"]): { vertices: number; faces: number; sides: number[] } | undefined {
  const positions = frame?.floats("positions");
  if (frame === null || positions === undefined) return undefined;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3] as number, x);
    high[i % 3] = Math.max(high[i % 3] as number, x);
  });
  const faces = (frame.indices("triangles")?.length ?? 0) / 3;
  return { vertices: positions.length / 3, faces, sides: high.map((most, k) => most - (low[k] as number)) };
}

/** Returns a word for how probable a rotation is, from 0 to 1. */
export function likelihoodWords(probability: number): string {
  if (probability >= 0.6) return "likely";
  if (probability >= 0.25) return "possible";
  return probability >= 0.05 ? "less likely" : "unlikely";
}
