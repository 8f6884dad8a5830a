import { computed, type ReadonlySignal } from "@preact/signals";
import type { Graft } from "./graft";
import type { LiveWords } from "../live_words";
import { inPanelWords } from "../wording";

/** Returns what the user has to do before a graft can start; undefined without a part. */
export function pairingWords(graft: Graft): string | undefined {
  const words = nextAction(graft);
  return words === undefined ? undefined : `${words}.`;
}

function nextAction(graft: Graft): string | undefined {
  const waiting = graft.parts.value.filter((part) => graft.isShown(part));
  if (waiting.length === 0) return undefined;
  const open = waiting.filter((part) => part.loops > 0);
  if (open.length === 0) return "The part has no open boundary: cut it first, by a plane or along a curve";
  if ((graft.model.value?.loops ?? 0) === 0)
    return "The model has no open boundary: cut it, or drop the part on its surface";
  return graft.picked.value === null
    ? "Click a loop of the model and a loop of a part: these two meet"
    : "Now click the loop of the other one that it meets";
}

/** Returns in few words what graft mode waits for. */
export function graftWords(graft: Graft): LiveWords {
  const idle = (text: string, explained = ""): LiveWords => ({ tone: "idle", text, explained });
  switch (graft.tool.value) {
    case "plane":
      return graft.cutPlane.value === null
        ? idle("Drag across the surface to lay the plane")
        : idle("Move the plane, then choose the side to keep");
    case "stroke":
      return graft.cutCurve.value?.closed === true
        ? idle("Choose the side to keep")
        : idle("Draw a closed curve around what is to come off");
    case "drop":
      return idle("Point where the part is to grow; a click, or letting go, grafts it");
    case "fixed":
      return idle("Paint what of the part must stay, then Done");
    case "loops":
      return graft.kept.value === undefined ? beforeGraft(graft) : inGraft(graft, graft.pairs.value.length);
  }
}

function beforeGraft(graft: Graft): LiveWords {
  const text = nextAction(graft) ?? "Add a part from the library, or drag one onto the surface";
  return { tone: "idle", text, explained: "" };
}

function inGraft(graft: Graft, pairs: number): LiveWords {
  const { value: report } = graft.report;
  if (report?.error !== undefined) {
    const { problem, remedy } = inPanelWords(report.error);
    return { tone: "problem", text: problem, explained: remedy };
  }
  if (pairs === 0 && graft.kept.value?.at === undefined)
    return { tone: "idle", text: "Click a loop on each to pair them", explained: "" };
  if ((report?.ambiguous_starts ?? []).length > 0)
    return { tone: "warning", text: "Say where the loops meet: drag their numbered starts, or twist", explained: "They fit alike in several ways." };
  if (graft.preview.value === null || graft.dragged.value !== null)
    return { tone: "busy", text: "Working out the graft", explained: "A preview comes in a moment." };
  return { tone: "good", text: "Grafted; Accept keeps it", explained: "Change it as you like before: the panel and the view show what comes of it." };
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
