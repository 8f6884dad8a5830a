import type { DocumentState, ProgressStage, ProgressTask, Accuracy, LiveStage } from "../protocol";
import type { Event } from "./editor";
import { inPanelWords, sentence } from "./wording";

export interface LiveWords {
  tone: "idle" | "busy" | "good" | "warning" | "problem";
  text: string;
  explained: string;
}

const accuracies: Record<Accuracy, [string, string]> = {
  proxy: ["Preview", "A simplified mesh stands in. The exact shape follows soon after you stop dragging."],
  reduced: ["Quick preview", "Usually accurate to a few per cent. The exact shape follows when you stop dragging."],
  linear: ["Exact", "Every frame is exact."],
  exact: ["Exact", "Saving writes this shape."],
};

const stages: Record<LiveStage, [LiveWords["tone"], string, string]> = {
  starting: ["busy", "Getting ready", "A first preview follows in a moment. You can already drag."],
  preview: ["busy", "Preview; preparing the exact shape", "You can already drag. The accuracy improves by itself."],
  exact: ["good", "Exact; preparing faster dragging", "The exact solution is ready. Faster frames are being prepared."],
  ready: ["good", "Ready", "Everything is prepared."],
  "proxy-only": [
    "warning",
    "Preview only",
    "The exact solution does not fit in this machine's memory. The preview is what is saved. A smaller region helps.",
  ],
  failed: ["problem", "Cannot be solved", "See the message."],
  closed: ["idle", "", ""],
};

/** Describes for the user what the live deformation is doing. */
export function liveWords(state: DocumentState | null, live: Event<"live">): LiveWords {
  if (state === null) return { tone: "idle", text: "Nothing open", explained: "" };
  if (state.handles.length === 0)
    return { tone: "idle", text: "No handle yet", explained: "Paint a handle, then drag its arrows." };
  if (state.counts === null)
    return { tone: "idle", text: "Nothing can move yet", explained: "The handle needs a region around it." };
  if (live.error !== undefined) {
    const { problem, remedy } = inPanelWords(live.error);
    return { tone: "problem", text: "Cannot be solved", explained: [sentence(problem), remedy].filter((text) => text !== "").join(". ") };
  }
  const [tone, text, explained] = stages[live.stage ?? "starting"];
  const accuracy = live.accuracy === undefined ? undefined : accuracies[live.accuracy];
  if (accuracy === undefined || tone !== "good") return { tone, text, explained };
  if (live.stage !== "exact") return { tone, text: accuracy[0], explained: accuracy[1] };
  if (live.accuracy === "proxy") return { tone: "busy", text: `${accuracy[0]}; the exact shape follows`, explained: accuracy[1] };
  return { tone, text, explained: accuracy[1] };
}

/** Words for the stages of the engine's progress. */
const progressStages: Record<ProgressStage, string> = {
  analyse: "preparing the equations",
  assemble: "setting up the equations",
  basis: "preparing fast frames",
  check: "checking the mesh",
  cut: "cutting",
  decimate: "simplifying the mesh",
  factorise: "solving the equations",
  find_surface: "finding the surface",
  graft: "grafting",
  intersections: "finding self-intersections",
  iterate: "solving",
  match: "finding the rotation",
  measure: "measuring the result",
  open: "opening a hole",
  path: "finding the path along the surface",
  read: "reading the file",
  reduce: "preparing fast frames",
  refine: "refining the mesh",
  render: "making a picture",
  repair: "repairing the mesh",
  rotations: "rotating the details",
  seam: "making the seam",
  select: "evaluating selections",
  shape_triangles: "improving the triangles",
  shell: "spreading the bends",
  skin: "attaching the surface to the preview",
  solve: "solving",
  write: "writing the file",
};

/** Words for the tasks of the engine's progress. */
const progressTasks: Record<ProgressTask, string> = {
  proxy: "making a preview",
  retry: "trying other settings for a better seam",
};

/** Words the engine's progress: by its task, or by its stage where it has no task. */
export function progressWords({ stage, within }: Pick<Event<"progress">, "stage" | "within">): string {
  return within === undefined ? progressStages[stage] : progressTasks[within];
}
