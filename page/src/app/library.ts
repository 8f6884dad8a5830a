import { signal, type Signal } from "@preact/signals";
import { MessageKind, type BinaryMessage } from "../engine/binary_message";
import type { Outcome } from "../engine/connection";
import type { Id, PageRequest } from "../protocol";

/** The object that a picture shows. */
export type Pictured = { sample: string } | Rendered;

/** An object whose picture the engine renders. */
type Rendered = { path: string } | { upload: string } | { mesh: string };

/** The address of a picture; null while it is made, "none" if there is none. */
export type Picture = string | null;

interface Wanted {
  readonly key: string;
  readonly of: Rendered;
}

const pictureSize = 128;

/**
 * Pictures of parts. Those of samples come with the page. The engine makes the others one after another, each once, and
 * none that is no longer shown.
 */
export class Library {
  private readonly pictures = new Map<string, Signal<Picture>>();
  private readonly shown = new Map<string, number>(); // how many components show a picture, by its key
  private readonly wanted: Wanted[][] = []; // lists of pictures requested together; the last list is made first
  private together: Wanted[] | undefined;
  private readonly coming = new Map<Id, string>(); // keys of pictures by request
  private busy = false;
  private paused: Promise<unknown> | undefined;
  private running: Id | undefined;

  constructor(private readonly send: (request: PageRequest) => { id: Id; answer: Promise<Outcome> }) {}

  /** Returns the picture, and requests it on the first call. A new `version` makes a new picture. */
  picture(of: Pictured, version = 0): Signal<Picture> {
    const key = keyOf(of, version);
    const known = this.pictures.get(key);
    if (known !== undefined) return known;
    const made = signal<Picture>("sample" in of ? `samples/${of.sample}.png` : null);
    this.pictures.set(key, made);
    if ("sample" in of) return made;
    const together = this.openList();
    if ("mesh" in of) together.unshift({ key, of }); // open objects come first
    else together.push({ key, of });
    if (!this.busy) void this.work();
    return made;
  }

  /** Notes that a component shows the picture, until the returned function is called. */
  show(of: Pictured, version = 0): () => void {
    const key = keyOf(of, version);
    this.shown.set(key, (this.shown.get(key) ?? 0) + 1);
    return () => {
      const left = (this.shown.get(key) ?? 1) - 1;
      this.shown.set(key, left);
      if (left === 0) this.withdraw(key);
    };
  }

  private withdraw(key: string): void {
    this.shown.delete(key);
    if (this.pictures.get(key)?.value !== null) return; // made already
    this.pictures.delete(key);
    for (const list of this.wanted) {
      const index = list.findIndex((wanted) => wanted.key === key);
      if (index >= 0) list.splice(index, 1);
    }
  }

  /** Pauses until `work` has ended. The picture in progress is cancelled and made again afterwards. */
  pauseFor(work: Promise<unknown>): void {
    const paused = work.finally(() => {
      if (this.paused === paused) this.paused = undefined;
    });
    this.paused = paused;
    if (this.running !== undefined) this.send({ do: "cancel", of: this.running }).answer.catch(() => undefined);
  }

  onMessage(message: BinaryMessage): void {
    if (message.kind !== MessageKind.thumbnail || message.header.of === undefined) return;
    const key = this.coming.get(message.header.of);
    const png = message.bytes("png");
    if (key !== undefined && png !== undefined) this.set(key, URL.createObjectURL(new Blob([png], { type: "image/png" })));
  }

  private openList(): Wanted[] {
    if (this.together !== undefined) return this.together;
    const list: Wanted[] = [];
    this.wanted.push(list);
    this.together = list;
    queueMicrotask(() => (this.together = undefined));
    return list;
  }

  private next(): Wanted | undefined {
    for (let last = this.wanted.at(-1); last !== undefined; last = this.wanted.at(-1)) {
      const first = last.shift();
      if (first !== undefined) return first;
      this.wanted.pop();
      if (last === this.together) this.together = undefined;
    }
    return undefined;
  }

  private async work(): Promise<void> {
    this.busy = true;
    for (let next = this.next(); next !== undefined; next = this.next()) {
      while (this.paused !== undefined) await this.paused;
      await this.make(next);
    }
    this.busy = false;
  }

  private async make(wanted: Wanted): Promise<void> {
    const { id, answer } = this.send({ do: "thumbnail", size: pictureSize, ...wanted.of });
    this.coming.set(id, wanted.key);
    this.running = id;
    try {
      await answer;
    } catch {
      if (this.paused === undefined) this.set(wanted.key, "none"); // no renderer in this build, or an unreadable file: an icon is shown
      else if (this.pictures.has(wanted.key)) this.wanted.push([wanted]);
    }
    this.running = undefined;
  }

  private set(key: string, picture: Picture): void {
    const known = this.pictures.get(key);
    if (known !== undefined) known.value = picture;
  }
}

function keyOf(of: Pictured, version: number): string {
  return `${JSON.stringify(of)} ${version}`;
}
