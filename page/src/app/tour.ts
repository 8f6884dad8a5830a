import { computed, effect, signal, untracked } from "@preact/signals";
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
  /** The words for those who use fingers; by default `words`. */
  readonly touchWords?: string;
  /** Selectors of what the bubble points at; the first one that is shown counts. */
  readonly anchors: readonly string[];
  /** The label of the button that does the step for the user. */
  readonly action: string;
  /** Whether the button can do it. Reads signals. */
  canRun?(editor: Toured): boolean;
  /** Does the step. */
  run(editor: Toured): unknown;
  /** Returns what the step adds to, as text: while it is the same as when the bubble came, the step is not done. */
  progress(editor: Toured): string;
  /** Returns whether the document shows what the step leads to. Both read signals. */
  isReached(editor: Toured): boolean;
}

const sample = "bust";
const part = "head";
const hasGraft = ({ graft }: Toured) => graft.kept.value !== undefined;
const handlesOf = ({ state }: Toured) => state.value?.handles ?? [];
const posesOf = (editor: Toured) => handlesOf(editor).map(({ pose }) => pose);
const isPosed = (pose: object) => Object.keys(pose).some((key) => key !== "pivot");
const graftsOf = ({ state }: Toured) => (state.value?.steps ?? []).filter(({ kind }) => kind === "merge").length;

export const tourSteps: readonly TourStep[] = [
  {
    title: "Open a model",
    words: "Click bust, a sample. Your own files are opened from a folder, or by dropping them on the page; the editor never changes them.",
    touchWords: "Tap bust, a sample. Your own files are opened from a folder; the editor never changes them.",
    anchors: [`[data-sample="${sample}"]`, ".file-button"],
    action: "Open bust",
    run: (editor) => editor.openInstead({ do: "open", sample }),
    progress: () => "",
    isReached: ({ state }) => state.value?.name === sample && state.value.file === "" && state.value.undo === null,
  },
  {
    title: "Graft another one onto it",
    words: "Choose Graft, then head in the library. The two open necks meet, and the head takes its place, turn and size from them.",
    anchors: [`[aria-label="Add ${part}"]`, '[data-mode="graft"]'],
    action: "Graft the head",
    canRun: ({ state }) => state.value !== null,
    run: async ({ graft }) => {
      graft.mode.value = "graft";
      await graft.addPart({ sample: part });
    },
    progress: () => "",
    isReached: (editor) => hasGraft(editor) && editor.graft.report.value?.error === undefined && editor.graft.report.value !== null,
  },
  {
    title: "Change it, and accept it",
    words: "Drag Twist or Tilt, and the result follows. Accept keeps the graft as a step, which you can still change later.",
    anchors: [".graft-end", ".graft-top", '[data-mode="graft"]'],
    action: "Accept the graft",
    canRun: hasGraft,
    run: ({ graft }) => graft.accept(),
    progress: (editor) => String(graftsOf(editor) - Number(hasGraft(editor))),
    isReached: (editor) => !hasGraft(editor) && graftsOf(editor) > 0,
  },
  {
    title: "Take hold of something",
    words: "Choose Deform, then the tool Handle, and paint over the nose. On release a gizmo appears. What you paint moves as one, and the surface within its reach follows.",
    touchWords:
      "Choose Deform, then the tool Handle, and paint over the nose with a finger. Lift it, and a gizmo appears. What you paint moves as one, and the surface within its reach follows.",
    anchors: ['.toolbar [data-label="Handle"]', '[data-mode="deform"]'],
    action: "Hold the head",
    canRun: (editor) => editor.box.value !== null && !hasGraft(editor),
    run: holdHead,
    progress: (editor) => JSON.stringify(handlesOf(editor).map(({ name }) => name)),
    isReached: (editor) => handlesOf(editor).length > 0,
  },
  {
    title: "Move it",
    words: "Drag the gizmo: arrows move, rings turn, boxes scale along an axis, the orange knob enlarges, the blue one sets the reach. Hold \\ to see the mesh before.",
    touchWords:
      "Drag the gizmo with a finger: arrows move, rings turn, boxes scale along an axis, the orange knob enlarges, the blue one sets the reach. Hold Before and after at the top to see the mesh before.",
    anchors: [".view"],
    action: "Turn the head",
    canRun: (editor) => handlesOf(editor).length > 0,
    run: turnHandle,
    progress: (editor) => JSON.stringify(posesOf(editor)),
    isReached: (editor) => editor.state.value?.undo === "pose" && posesOf(editor).some(isPosed),
  },
  {
    title: "Keep it",
    words: "Save writes all steps to an edit file, Export writes the mesh. Undo goes back as far as you like. You find this tour again under Help.",
    anchors: ['[data-label="Save"]', ".file-button"],
    action: "Finish",
    run: () => undefined,
    progress: () => "",
    isReached: () => false,
  },
];

/** Returns the name, with a number after it if it is taken. */
export function freeName(name: string, taken: readonly string[]): string {
  for (let number = 1; ; ++number) {
    const free = number === 1 ? name : `${name} ${String(number)}`;
    if (!taken.includes(free)) return free;
  }
}

/** Makes a handle of the upper part of the model. */
async function holdHead(editor: Toured): Promise<void> {
  const { box, graft, state, tools } = editor;
  graft.mode.value = "deform";
  if (box.value === null) return;
  const { low, high } = box.value;
  const point: [number, number, number] = [0, 0, low[2] + 0.62 * (high[2] - low[2])];
  const reach = 0.1 * (state.value?.model.diagonal ?? 1);
  const select = { half_space: { point, normal: [0, 0, 1] as [number, number, number] } };
  const name = freeName(part, handlesOf(editor).map((handle) => handle.name));
  const done = await editor.ask({ do: "handle", what: "add", name, select, reach });
  if (done !== undefined) tools.activeHandle.value = name;
}

async function turnHandle(editor: Toured): Promise<void> {
  const handle = editor.state.value?.handles[0];
  if (handle !== undefined) await editor.pose({ [handle.name]: { rotate: { axis: [0, 1, 0], angle_deg: 15 } } });
}

/** The shown bubble, and the progress of its step when it came. */
interface Place {
  readonly index: number;
  readonly before: string;
}

/**
 * Leads through an edit of a sample, bubble by bubble. Each goes on once the user has done what it says, or has chosen to
 * go on without it. A reload resumes the tour.
 */
export class Tour {
  private readonly place = signal<Place | null>(placeBeforeReload());
  /** The shown bubble; null: none. */
  readonly index = computed(() => this.place.value?.index ?? null);
  private readonly seen = remembered("tour seen", false);

  constructor(private readonly editor: Toured) {
    effect(() => rememberPlace(this.place.value));
    effect(() => this.beginOnce());
    effect(() => this.follow());
  }

  get step(): TourStep | undefined {
    return this.index.value === null ? undefined : tourSteps[this.index.value];
  }
  /** Whether the shown step is the last one. */
  get isLast(): boolean {
    return this.index.value === tourSteps.length - 1;
  }
  /** Whether the button of the shown step can do it now. */
  get canRun(): boolean {
    return this.step?.canRun?.(this.editor) ?? true;
  }
  /** Whether the shown step may be left out: all later ones need an open model. */
  get canPass(): boolean {
    return !this.isLast && this.editor.state.value !== null;
  }

  start(): void {
    this.editor.dialog.value = null;
    this.seen.value = true;
    this.goTo(0);
  }

  /** Does the step for the user. The next bubble comes once it is done; the last one ends the tour. */
  async run(): Promise<void> {
    if (this.isLast) this.skip();
    else await this.step?.run(this.editor);
  }

  /** Goes on without the step. */
  pass(): void {
    if (this.index.value !== null && this.canPass) this.goTo(this.index.value + 1);
  }

  /** Ends the tour. Returns whether it was shown. */
  skip(): boolean {
    const wasShown = this.place.value !== null;
    this.place.value = null;
    return wasShown;
  }

  private goTo(index: number): void {
    this.place.value = { index, before: tourSteps[index]?.progress(this.editor) ?? "" };
  }

  /** Begins the tour at the first start, unless there is something else to do. */
  private beginOnce(): void {
    const { welcome, isWaitedFor, state } = this.editor;
    if (welcome.value === null || this.seen.value) return;
    const hasOther = welcome.value.models.length > 0 || isWaitedFor.value || state.value !== null;
    if (!hasOther) untracked(() => this.start());
  }

  private follow(): void {
    const { value: place } = this.place;
    if (place !== null && this.isDone(place)) untracked(() => this.goTo(place.index + 1));
  }

  private isDone({ index, before }: Place): boolean {
    const step = tourSteps[index];
    if (step === undefined || !step.isReached(this.editor)) return false;
    const progress = step.progress(this.editor);
    return progress === "" || progress !== before;
  }
}

const placeKey = "meshgraft tour";

/** Returns where the tour was in this tab before a reload; null: it was not shown. */
function placeBeforeReload(): Place | null {
  try {
    const place = JSON.parse(sessionStorage.getItem(placeKey) ?? "null") as Partial<Place> | null;
    const { index, before } = place ?? {};
    return typeof index === "number" && tourSteps[index] !== undefined && typeof before === "string" ? { index, before } : null;
  } catch {
    return null;
  }
}

function rememberPlace(place: Place | null): void {
  try {
    sessionStorage.setItem(placeKey, JSON.stringify(place));
  } catch {
    // A reload then ends the tour.
  }
}
