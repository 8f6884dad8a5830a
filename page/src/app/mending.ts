import { computed, type ReadonlySignal } from "@preact/signals";
import type { Outcome } from "../engine/connection";
import type { DocumentState, PageRequest } from "../protocol";
import type { Marking } from "./marking";
import { noteWords } from "./wording";

export type Finding = DocumentState["model"]["findings"][number];
type FindingKind = Finding["kind"];

/** The objects of the editor that mending uses. */
export interface MendingLinks {
  readonly state: ReadonlySignal<DocumentState | null>;
  readonly marking: Marking;
  ask(request: PageRequest): Promise<Outcome | undefined>;
  note(problem: string): void;
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

  constructor(private readonly links: MendingLinks) {}

  isMarked(object: string, kind: FindingKind): boolean {
    return this.links.marking.marked.value === keyOf(object, kind);
  }

  /** Lights up all defects of a kind; a second time hides them again. */
  toggle(object: string, kind: FindingKind): Promise<void> {
    return this.links.marking.toggle(keyOf(object, kind), { do: "mark", mesh: object, finding: kind });
  }

  /** Repairs defects of these kinds; without kinds, all. Tells what was changed. */
  async mend(object: string, kinds?: FindingKind[]): Promise<void> {
    const answer = await this.links.ask({ do: "repair", mesh: object, ...(kinds === undefined ? {} : { kinds }) });
    if (answer !== undefined) this.links.note(mendedWords(answer.notes ?? []));
  }

  async closeHoles(object: string): Promise<void> {
    const answer = await this.links.ask({ do: "repair", mesh: object, holes: true });
    if (answer === undefined) return;
    const { notes = [] } = answer;
    this.links.note(notes.length > 0 ? mendedWords(notes) : nothingClosed);
  }

  /** Repairs all defects of these objects. */
  async mendAll(objects: readonly string[]): Promise<void> {
    const notes: NonNullable<Outcome["notes"]> = [];
    for (const { name, findings } of this.defective.value) {
      if (!objects.includes(name) || !findings.some(({ repairable }) => repairable)) continue;
      const answer = await this.links.ask({ do: "repair", mesh: name });
      if (answer === undefined) return;
      notes.push(...(answer.notes ?? []));
    }
    this.links.note(mendedWords(notes));
  }
}

const nothingClosed = "Nothing was closed: what is open is the border of a sheet, not a hole. Show leads there.";

function keyOf(object: string, kind: FindingKind): string {
  return `${kind} of ${object}`;
}

/** Returns a sentence on what a repair has changed. */
export function mendedWords(notes: NonNullable<Outcome["notes"]>): string {
  if (notes.length === 0) return "Nothing had to be mended.";
  return ["Mended.", ...notes.map(noteWords)].join(" ");
}
