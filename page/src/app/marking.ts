import { signal } from "@preact/signals";
import type { Outcome } from "../engine/connection";
import type { DocumentState, PageRequest } from "../protocol";

type MarkRequest = Extract<PageRequest, { do: "mark" }>;

/** The functions of the editor that lighting up uses. */
export interface MarkingLinks {
  ask(request: PageRequest): Promise<Outcome | undefined>;
  note(problem: string, remedy?: string): void;
  hideMarks(): void;
}

/** What the view lights up: at most one thing at a time. */
export class Marking {
  /** The key of what is lit up. */
  readonly marked = signal<string | null>(null);
  private steps = "";

  constructor(private readonly links: MarkingLinks) {}

  /** Lights up the places that a request asks for, and moves the camera to them; a second time hides them. */
  async toggle(key: string, request: MarkRequest): Promise<void> {
    const wasMarked = this.marked.value === key;
    this.hide();
    if (wasMarked) return;
    const answer = await this.links.ask(request);
    if (answer === undefined) return;
    if (answer.marked === 0) this.links.note("there is no place to show", "They have no position.");
    else this.marked.value = key;
  }

  /** Hides what is lit up if the steps have changed, because the surface may be elsewhere. Returns whether they have. */
  onState({ steps, model }: DocumentState): boolean {
    const now = JSON.stringify([model.mesh, steps]);
    const changed = now !== this.steps;
    if (changed) this.hide();
    this.steps = now;
    return changed;
  }

  hide(): void {
    if (this.marked.value !== null) this.links.hideMarks();
    this.marked.value = null;
  }
}
