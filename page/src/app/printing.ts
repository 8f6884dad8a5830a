import { signal, type ReadonlySignal } from "@preact/signals";
import type { Outcome } from "../engine/connection";
import type { DocumentState, PageRequest, Vector } from "../protocol";
import type { Marking } from "./marking";
import type { PrintCheck, PrintFinding } from "./print_words";

/** The objects of the editor that printing uses. */
export interface PrintingLinks {
  readonly state: ReadonlySignal<DocumentState | null>;
  readonly marking: Marking;
  ask(request: PageRequest): Promise<Outcome | undefined>;
  /** Shows a part beside the model. */
  showPart(name: string): void;
  /** Returns the direction away from the bed. */
  up(): Vector;
}

/** The check of the edited mesh before it is printed. */
export class Printing {
  /** What was found; null if nothing was checked since the last change. */
  readonly result = signal<PrintCheck | null>(null);
  /** The object that is checked; empty: the model. */
  readonly object = signal("");
  readonly overhangDeg = signal(45);
  /** Thinnest wall that can be printed, model units. */
  readonly leastWall = signal(0);
  /** The largest mesh that the export dialog checks without being asked to, in faces. */
  readonly mostFacesUnasked = signal(300_000);

  constructor(private readonly links: PrintingLinks) {}

  async check(): Promise<void> {
    const object = this.checked();
    const answer = await this.links.ask({
      do: "print-check",
      ...(object !== undefined && { mesh: object.name }),
      up: this.links.up(),
      overhang_deg: this.overhangDeg.value,
      least_wall: this.leastWall.value,
    });
    if (answer?.print !== undefined) this.result.value = answer.print;
  }

  /** The part that is checked; undefined for the model. */
  checked(): DocumentState["parts"][number] | undefined {
    return this.links.state.value?.parts.find(({ name }) => name === this.object.value);
  }

  /** Chooses the object that is checked. */
  choose(name: string): void {
    this.links.marking.hide();
    this.object.value = name;
    this.result.value = null;
  }

  /** Checks again if there was a check, because a limit has changed. */
  async renew(): Promise<void> {
    this.links.marking.hide();
    if (this.result.value !== null) await this.check();
  }

  isMarked(finding: PrintFinding): boolean {
    return this.links.marking.marked.value === keyOf(finding);
  }

  toggle(finding: PrintFinding): Promise<void> {
    const object = this.checked();
    if (object !== undefined && !this.isMarked(finding)) this.links.showPart(object.name);
    return this.links.marking.toggle(keyOf(finding), { do: "mark", print: finding, ...(object !== undefined && { mesh: object.name }) });
  }

  /** Forgets what was found before a change. */
  forget(): void {
    this.result.value = null;
  }
}

function keyOf(finding: PrintFinding): string {
  return `print ${finding}`;
}
