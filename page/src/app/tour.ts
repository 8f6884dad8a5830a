import { effect, signal, untracked } from "@preact/signals";
import type { Editor } from "./editor";
import { remembered } from "./remembered";

/** The parts of the editor that the tour uses. */
type Toured = Pick<
  Editor,
  "ask" | "box" | "dialog" | "graft" | "isWaitedFor" | "openInstead" | "pose" | "state" | "tools" | "welcome"
>;

/** One bubble of the tour. */
export interface TourStep {
  readonly title: string;
  readonly words: string;
  /** Selectors of what the bubble points at; the first one that is shown counts. */
  readonly anchors: readonly string[];
  /** The label of the button that does the step for the user. */
  readonly action: string;
  /** Does the step. */
  run(editor: Toured): unknown;
  /** Returns whether the user has done it. Reads signals. */
  isDone(editor: Toured): boolean;
}

const sample = "bust";
const part = "head";
const isOnSample = ({ state }: Toured) => state.value?.name === sample && state.value.file === "" && state.value.undo === null;
const hasGraft = ({ graft }: Toured) => graft.kept.value !== undefined;

export const tourSteps: readonly TourStep[] = [
  {
    title: "Open a model",
    words: "Click bust, a sample. Your own files are opened from a folder, or by dropping them on the page; the editor never changes them.",
    anchors: [`[data-sample="${sample}"]`, ".file-button"],
    action: "Open bust",
    run: (editor) => editor.openInstead({ do: "open", sample }),
    isDone: isOnSample,
  },
  {
    title: "Graft another one onto it",
    words: "Choose Graft, then head in the library. The two open necks meet, and the head takes its place, turn and size from them.",
    anchors: [`[aria-label="Add ${part}"]`, '[data-mode="graft"]'],
    action: "Graft the head",
    run: async ({ graft }) => {
      graft.mode.value = "graft";
      await graft.addPart({ sample: part });
    },
    isDone: (editor) => hasGraft(editor) && editor.graft.report.value?.error === undefined && editor.graft.report.value !== null,
  },
  {
    title: "Change it, and accept it",
    words: "Drag Twist or Tilt, and the result follows. Accept keeps the graft as a step, which you can still change later.",
    anchors: [".graft-end", ".graft-top", '[data-mode="graft"]'],
    action: "Accept the graft",
    run: ({ graft }) => graft.accept(),
    isDone: (editor) => !hasGraft(editor) && editor.state.value?.steps.some(({ kind }) => kind === "merge") === true,
  },
  {
    title: "Take hold of something",
    words: "Choose Deform, then the tool Handle, and paint over the nose. On release a gizmo appears. What you paint moves as one, and the surface within its reach follows.",
    anchors: ['.toolbar [data-label="Handle"]', '[data-mode="deform"]'],
    action: "Hold the head",
    run: holdHead,
    isDone: ({ state }) => (state.value?.handles.length ?? 0) > 0,
  },
  {
    title: "Move it",
    words: "Drag the gizmo: arrows move, rings turn, boxes scale along an axis, the orange knob enlarges, the blue one sets the reach. Hold \\ to see the mesh before.",
    anchors: [".view"],
    action: "Turn the head",
    run: turnHandle,
    isDone: ({ state }) => state.value?.handles.some(({ pose }) => Object.keys(pose).some((key) => key !== "pivot")) === true,
  },
  {
    title: "Keep it",
    words: "Save writes all steps to an edit file, Export writes the mesh. Undo goes back as far as you like. You find this tour again under Help.",
    anchors: ['[data-label="Save"]', ".file-button"],
    action: "Finish",
    run: () => undefined,
    isDone: () => false,
  },
];

/** Makes a handle of the upper part of the model. */
async function holdHead(editor: Toured): Promise<void> {
  const { box, graft, state, tools } = editor;
  graft.mode.value = "deform";
  if (box.value === null) return;
  const { low, high } = box.value;
  const point: [number, number, number] = [0, 0, low[2] + 0.62 * (high[2] - low[2])];
  const reach = 0.1 * (state.value?.model.diagonal ?? 1);
  const select = { half_space: { point, normal: [0, 0, 1] as [number, number, number] } };
  const done = await editor.ask({ do: "handle", what: "add", name: part, select, reach });
  if (done !== undefined) tools.activeHandle.value = part;
}

async function turnHandle(editor: Toured): Promise<void> {
  const handle = editor.state.value?.handles[0];
  if (handle !== undefined) await editor.pose({ [handle.name]: { rotate: { axis: [0, 1, 0], angle_deg: 15 } } });
}

/** Leads through an edit of a sample, bubble by bubble. Each goes on by itself once the user has done what it says. */
export class Tour {
  /** The shown bubble; null: none. */
  readonly index = signal<number | null>(null);
  private readonly seen = remembered("tour seen", false);

  constructor(private readonly editor: Toured) {
    effect(() => this.beginOnce());
    effect(() => this.follow());
  }

  get step(): TourStep | undefined {
    return this.index.value === null ? undefined : tourSteps[this.index.value];
  }

  start(): void {
    this.editor.dialog.value = null;
    this.seen.value = true;
    this.index.value = 0;
  }

  /** Does the step for the user, and goes on. */
  async next(): Promise<void> {
    const { step } = this;
    const { value: index } = this.index;
    if (step === undefined || index === null) return;
    if (!step.isDone(this.editor)) await step.run(this.editor);
    if (this.index.value === index && index > 0) this.goTo(index + 1); // the first one waits until the sample is open
  }

  /** Ends the tour. Returns whether it was shown. */
  skip(): boolean {
    const wasShown = this.index.value !== null;
    this.index.value = null;
    return wasShown;
  }

  private goTo(index: number): void {
    this.index.value = index < tourSteps.length ? index : null;
  }

  /** Begins the tour at the first start, unless there is something else to do. */
  private beginOnce(): void {
    const { welcome, isWaitedFor, state } = this.editor;
    if (welcome.value === null || this.seen.value) return;
    const hasOther = welcome.value.models.length > 0 || isWaitedFor.value || state.value !== null;
    if (!hasOther) untracked(() => this.start());
  }

  private follow(): void {
    const { value: index } = this.index;
    if (index !== null && tourSteps[index]?.isDone(this.editor) === true) untracked(() => this.goTo(index + 1));
  }
}
