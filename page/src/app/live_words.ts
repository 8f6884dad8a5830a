import type { DocumentState, ProgressStage, ProgressTask, Accuracy, LiveStage } from "../protocol";
import type { Event } from "./editor";
import { inPanelWords } from "./wording";

export interface LiveWords {
  tone: "idle" | "busy" | "good" | "warning" | "problem";
  text: string;
  explained: string;
}

const accuracies: Record<Accuracy, [string, string]> = {
  proxy: ["Preview", "A simplified mesh stands in while the exact solution is prepared."],
  reduced: ["Quick preview", "Good to some per cent; the exact shape follows when the handle rests."],
  linear: ["Exact", "Each frame is exact, to rounding."],
  exact: ["Exact", "Saving writes this shape."],
};

const stages: Record<LiveStage, [LiveWords["tone"], string, string]> = {
  starting: ["busy", "Getting ready", "A first preview comes in a moment. You may drag already."],
  preview: ["busy", "Preview; the exact shape is being prepared", "Drag as you like: it gets better by itself."],
  exact: ["good", "Exact; making drags quicker", "The exact solution is there; quicker frames are being prepared."],
  ready: ["good", "Ready", "All is prepared."],
  "proxy-only": [
    "warning",
    "Preview only",
    "The exact solution does not fit into this machine's memory. Saving solves what is shown here. A smaller region helps.",
  ],
  failed: ["problem", "Cannot be solved", "See the message."],
  closed: ["idle", "", ""],
};

/** Describes for the user what the live deformation is doing. */
export function liveWords(state: DocumentState | null, live: Event<"live">): LiveWords {
  if (state === null) return { tone: "idle", text: "Nothing open", explained: "" };
  if (state.handles.length === 0)
    return { tone: "idle", text: "No handle yet", explained: "Paint a handle to have something to pull by." };
  if (state.counts === null)
    return { tone: "idle", text: "Nothing can move yet", explained: "The handle needs a region around it." };
  if (live.error !== undefined) {
    const { problem, remedy } = inPanelWords(live.error);
    return { tone: "problem", text: problem, explained: remedy };
  }
  const [tone, text, explained] = stages[live.stage ?? "starting"];
  const accuracy = live.accuracy === undefined ? undefined : accuracies[live.accuracy];
  if (accuracy === undefined || tone !== "good") return { tone, text, explained };
  return { tone, text: live.stage === "exact" ? text : accuracy[0], explained: accuracy[1] };
}

/** Words for the stages of the engine's progress. */
const progressStages: Record<ProgressStage, string> = {
  analyse: "planning the solve",
  assemble: "setting up the equations",
  basis: "preparing quick frames",
  check: "checking the mesh",
  cut: "cutting",
  decimate: "simplifying the mesh",
  factorise: "solving the equations",
  find_surface: "finding the surface",
  graft: "grafting",
  intersections: "looking for intersections",
  iterate: "solving",
  match: "matching the loops",
  measure: "measuring the result",
  open: "opening a hole",
  path: "finding the way along the surface",
  read: "reading the file",
  reduce: "preparing quick frames",
  refine: "refining the mesh",
  render: "making a picture",
  repair: "repairing the mesh",
  rotations: "turning the details",
  seam: "making the seam",
  select: "finding what is selected",
  shape_triangles: "shaping triangles",
  skin: "covering the surface",
  solve: "solving",
  write: "writing the file",
};

/** Words for the tasks of the engine's progress. */
const progressTasks: Record<ProgressTask, string> = {
  proxy: "making a preview",
};

/** Words the engine's progress: by its task, or by its stage where it has no task. */
export function progressWords({ stage, within }: Pick<Event<"progress">, "stage" | "within">): string {
  return within === undefined ? progressStages[stage] : progressTasks[within];
}
