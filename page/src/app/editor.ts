import { batch, computed, signal } from "@preact/signals";
import { FrameKind, type BinaryFrame } from "../engine/binary_frame";
import { Connection, Refusal, type Link, type Outcome } from "../engine/connection";
import type { DocumentState, EngineError, EngineEvent, PageRequest, Pose, Poses } from "../protocol";
import type { Viewport } from "../view/viewport";
import { ToolSettings } from "./tool_settings";
import type { ViewSettings } from "./view_settings";

export type Event<Name> = Extract<EngineEvent, { event: Name }>;

/** Something to tell the person; it stays until it is read. */
export interface Message {
  key: number;
  kind: "problem" | "note";
  error: EngineError;
}

/**
 * What the page knows: the engine's state as signals that panels read, and what can be asked of the engine.
 * Frames go straight to the viewport.
 */
export class Editor {
  readonly tools = new ToolSettings();
  readonly link = signal<Link>("connecting");
  readonly welcome = signal<Event<"welcome"> | null>(null);
  readonly state = signal<DocumentState | null>(null);
  readonly offer = signal<Event<"offer-restore"> | null>(null);
  readonly live = signal<Event<"live">>({ event: "live" });
  readonly progress = signal<ReadonlyMap<string, Event<"progress">>>(new Map());
  readonly messages = signal<readonly Message[]>([]);
  readonly selected = signal(0);
  readonly isOpen = computed(() => this.state.value !== null);

  private readonly connection: Connection;
  private lastMessage = 0;
  private asked = 0;

  constructor(
    readonly token: string,
    private readonly viewport: Viewport,
    readonly view: ViewSettings,
  ) {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    this.connection = new Connection(`${scheme}//${location.host}/session?token=${encodeURIComponent(token)}`, {
      event: (event) => this.hear(event),
      frame: (frame) => this.show(frame),
      link: (link) => (this.link.value = link),
    });
  }

  start(): void {
    this.connection.open();
  }

  /** Asks the engine; a refusal becomes a message to the person, and undefined. */
  async ask(request: PageRequest): Promise<Outcome | undefined> {
    ++this.asked;
    try {
      return await this.connection.request(request);
    } catch (failure) {
      if (!(failure instanceof Refusal)) throw failure;
      if (failure.error.code !== "cancelled") this.tell("problem", failure.error);
      return undefined;
    } finally {
      --this.asked;
    }
  }

  /** Whether everything that was asked has been answered. */
  isIdle(): boolean {
    return this.asked === 0;
  }

  /** Where handles are for now: what the engine streams, and what the shader shows at once. */
  drag(poses: Poses): void {
    const answered = this.viewport.posesAsked();
    this.connection.request({ do: "drag", poses }).then(
      (outcome) => answered("pose" in outcome ? (outcome.pose ?? 0) : 0),
      () => answered(0),
    );
  }

  /** Where handles are from now on. */
  async pose(poses: Record<string, Pose>): Promise<Outcome | undefined> {
    const answered = this.viewport.posesAsked();
    const outcome = await this.ask({ do: "pose", poses });
    answered(outcome !== undefined && "pose" in outcome ? (outcome.pose ?? 0) : 0);
    return outcome;
  }

  tell(kind: Message["kind"], error: EngineError): void {
    this.messages.value = [...this.messages.value, { key: ++this.lastMessage, kind, error }];
  }
  dismiss(key: number): void {
    this.messages.value = this.messages.value.filter((message) => message.key !== key);
  }

  private hear(event: EngineEvent): void {
    switch (event.event) {
      case "welcome":
        this.welcome.value = event;
        break;
      case "state":
        batch(() => {
          this.state.value = event;
          this.selected.value = event.selected;
        });
        this.viewport.setDocument(event);
        break;
      case "progress":
        this.note_progress(event);
        break;
      case "live":
        this.live.value = { ...this.live.value, ...event };
        break;
      case "offer-restore":
        this.offer.value = event;
        break;
      case "notice":
        this.tell("problem", event.error);
        break;
    }
  }

  private note_progress(event: Event<"progress">): void {
    const all = new Map(this.progress.value);
    if (event.fraction >= 1) all.delete(String(event.of));
    else all.set(String(event.of), event);
    this.progress.value = all;
  }

  private show(frame: BinaryFrame): void {
    this.viewport.show(frame);
    if (frame.kind === FrameKind.selection) this.selected.value = frame.indices("vertices")?.length ?? 0;
  }
}
