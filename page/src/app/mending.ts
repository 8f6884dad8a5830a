import { computed, signal, type ReadonlySignal } from "@preact/signals";
import type { Outcome } from "../engine/connection";
import type { DocumentState, PageRequest } from "../protocol";
import { noteWords } from "./wording";

export type Finding = DocumentState["model"]["findings"][number];
type FindingKind = Finding["kind"];

/** The functions of the editor that mending uses. */
export interface MendingLinks {
  readonly state: ReadonlySignal<DocumentState | null>;
  ask(request: PageRequest): Promise<Outcome | undefined>;
  note(problem: string, remedy?: string): void;
  hideMarks(): void;
}

/** What the view lights up: an object and one kind of its defects. */
interface Marked {
  readonly object: string;
  readonly kind: FindingKind;
}

/** The defects of the model and of the parts: shows where they are, and repairs them. */
export class Mending {
  /** The objects that have defects, the model first. */
  readonly defective = computed(() => {
    const { value: state } = this.links.state;
    if (state === null) return [];
    return [state.model, ...state.parts].filter(({ findings }) => findings.length > 0);
  });
  /** Whether defects can be repaired now. A graft must be accepted or cancelled first. */
  readonly canMend = computed(() => this.links.state.value?.graft === null);
  readonly marked = signal<Marked | null>(null);
  private steps = "";

  constructor(private readonly links: MendingLinks) {}

  isMarked(object: string, kind: FindingKind): boolean {
    return this.marked.value?.object === object && this.marked.value.kind === kind;
  }

  /** Lights up all defects of a kind and moves the camera to them; a second time hides them again. */
  async toggle(object: string, kind: FindingKind): Promise<void> {
    const wasMarked = this.isMarked(object, kind);
    this.hide();
    if (wasMarked) return;
    const answer = await this.links.ask({ do: "mark", mesh: object, finding: kind });
    if (answer === undefined) return;
    if (answer.marked === 0) this.links.note("there is no place to show", "They have no position.");
    else this.marked.value = { object, kind };
  }

  /** Repairs defects of these kinds; without kinds, all. Tells what was changed. */
  async mend(object: string, kinds?: FindingKind[]): Promise<void> {
    const answer = await this.links.ask({ do: "repair", mesh: object, ...(kinds === undefined ? {} : { kinds }) });
    if (answer !== undefined) this.links.note(mendedWords(answer.notes ?? []));
  }

  async mendAll(): Promise<void> {
    for (const { name, findings } of this.defective.value)
      if (findings.some(({ repairable }) => repairable)) await this.mend(name);
  }

  /** Hides what is lit up if the steps have changed, because the surface may be elsewhere. */
  onState({ steps, model }: DocumentState): void {
    const now = JSON.stringify([model.mesh, steps]);
    if (now !== this.steps) this.hide();
    this.steps = now;
  }

  private hide(): void {
    if (this.marked.value !== null) this.links.hideMarks();
    this.marked.value = null;
  }
}

/** Returns a sentence on what a repair has changed. */
export function mendedWords(notes: NonNullable<Outcome["notes"]>): string {
  if (notes.length === 0) return "Nothing had to be mended.";
  return ["Mended.", ...notes.map(noteWords)].join(" ");
}
