import { mirrorLatestGraft } from "./graft/mirror_latest";
import { laterStepWords } from "./graft/set_aside";
import { batch, computed, effect, signal, untracked } from "@preact/signals";
import { MessageKind, type BinaryMessage } from "../engine/binary_message";
import { Connection, LostConnection, Refusal, type Link, type Outcome } from "../engine/connection";
import type { DocumentState, EngineEvent, Id, Note, PageRequest, Pose, Poses, Vector } from "../protocol";
import type { Surface } from "../view/surface/surface";
import type { Viewport } from "../view/viewport";
import { announcementOf, openedWords } from "./announcements";
import { engineUrl } from "./engine_url";
import { Folders } from "./folders";
import { Graft } from "./graft/graft";
import { Library } from "./library";
import { Marking } from "./marking";
import { Mending } from "./mending";
import { nearestAxis, planeAcross } from "./mirror_plane";
import { baseName, folderOf } from "./paths";
import { Printing } from "./printing";
import { openBeforeReload, rememberOpen, rememberOpened, rememberUnsaved } from "./recent";
import { remedyOf, remedyOfPage, type PageRemedy } from "./remedies";
import { labelOf } from "./request_labels";
import { shapedWords } from "./shaping";
import { asPercent, mirrorTolerance, sufficientTolerance, withTolerance } from "./symmetry";
import { changingTools, ToolSettings, type ToolName } from "./tool_settings";
import { counted, formatNumber, unitsOfFiles } from "./units";
import { keyOfUpload } from "./upload";
import type { ViewSettings } from "./view_settings";
import {
  fileToReplace, inPanelWords, noteWords, toldOf, toldOfNote,
  type Failure, type PageError, type Told,
} from "./wording";

export type Event<Name> = Extract<EngineEvent, { event: Name }>;
export type OpenRequest = Extract<PageRequest, { do: "open" }>;

/** A message to the user. It stays until the user closes it or it is outdated. */
export interface Message {
  key: number;
  kind: "problem" | "note";
  told: Told;
  /** The request that was refused. The message is removed once a request of this kind succeeds. */
  of?: PageRequest["do"] | "live" | undefined;
  /** What it is about. A later message on the same topic takes its place; without a topic it stands beside others. */
  topic?: string | undefined;
  /** A remedy, offered as a button. */
  offer?: { label: string; run: () => void } | undefined;
}

/** Returns the messages with one more. It takes the place of one that says the same or is on the same topic. */
export function withMessage(messages: readonly Message[], message: Message): readonly Message[] {
  const isSame = ({ told }: Message) => told.problem === message.told.problem && told.location === message.told.location;
  if (messages.some(isSame)) return messages;
  const topicOf = ({ topic, of }: Message) => topic ?? of;
  return [...messages.filter((other) => topicOf(other) === undefined || topicOf(other) !== topicOf(message)), message];
}

/** A document that will replace the open one. */
export interface PendingOpen {
  name: string;
  open: () => unknown;
}

const noAnswer: PageError = {
  code: "io",
  problem: "meshgraft does not answer",
  location: "",
  remedy: "Is the program still running where it was started? This page reconnects by itself.",
};

const fileRequests: ReadonlySet<Message["of"]> = new Set(["open", "save", "export", "part", "list", "restore", "discard"]);

/** A request that the engine is working on. */
export interface RunningRequest {
  id: Id;
  label: string;
  since: number; // milliseconds of performance.now()
}

export interface Box {
  low: Vector;
  high: Vector;
}

export type DialogName = "open" | "save" | "export" | "help";

/**
 * Holds the engine's state as signals that panels read, and sends requests to the engine. Binary messages go straight to
 * the viewport.
 */
export class Editor {
  readonly tools = new ToolSettings();
  /** The chosen tool, or Navigate in place of one that would change the model while a graft is edited. */
  readonly toolInUse = computed((): ToolName => {
    const chosen = this.tools.tool.value;
    return changingTools.has(chosen) && this.graft.isEdited.value ? "navigate" : chosen;
  });
  readonly graft: Graft;
  readonly folders: Folders;
  readonly library: Library;
  readonly mending: Mending;
  readonly printing: Printing;
  readonly link = signal<Link>("connecting");
  /** Whether the engine was restarted and no longer accepts this page's token. */
  readonly expired = signal(false);
  readonly welcome = signal<Event<"welcome"> | null>(null);
  readonly state = signal<DocumentState | null>(null);
  readonly offer = signal<Event<"offer-restore"> | null>(null);
  readonly live = signal<Event<"live">>({ event: "live" });
  /** Seconds that the set-up of the live deformation took until it was exact; undefined before. */
  readonly setupSeconds = signal<number | undefined>(undefined);
  readonly progress = signal<ReadonlyMap<string, Event<"progress">>>(new Map());
  readonly working = signal<ReadonlyMap<Id, RunningRequest>>(new Map());
  readonly messages = signal<readonly Message[]>([]);
  readonly selected = signal(0);
  /** The latest words for screen readers alone. */
  readonly announced = signal("");
  /** The bounding box of the model at rest, in model units. */
  readonly box = signal<Box | null>(null);
  readonly dialog = signal<DialogName | null>(null);
  /** The name of the object that the export dialog begins with; empty for the model. */
  readonly toExport = signal("");
  /** The edit file that a save would overwrite although another program or tab has changed it since it was opened. */
  readonly replacing = signal<string | null>(null);
  /** Counts the times that files were written, so that lists of files are renewed. */
  readonly filesWritten = signal(0);
  /** The document to open once the user has decided about unsaved work. */
  readonly pendingOpen = signal<PendingOpen | null>(null);
  readonly isOpen = computed(() => this.state.value !== null);
  /** Whether the document has changes that are not saved. They stay unsaved while a lost connection comes back. */
  readonly unsaved = computed(() => {
    const { value: state } = this.state;
    return !this.isWaitedFor.value && (this.bringsBack.value || state?.dirty === true);
  });
  /** Whether a program waits for the result. It gets every change, so nothing is left to save. */
  readonly isWaitedFor = computed(() => this.welcome.value?.waited_for === true);
  /** Whether the work is done, and the program that waited for it has it. */
  readonly handedBack = signal(false);

  private readonly marking: Marking;
  private readonly connection: Connection;
  private lastMessage = 0;
  private setupBegan: number | undefined;
  private readonly opened = signal<OpenRequest | undefined>(undefined);
  /** The document to reopen, with all its changes, as soon as the engine answers. */
  private reopening: { to: OpenRequest | undefined; since: string } | undefined;
  private readonly bringsBack = signal(false); // the unsaved changes of the document to reopen
  private restoring: Promise<void> | undefined;

  constructor(
    readonly token: string,
    private readonly viewport: Viewport,
    readonly view: ViewSettings,
  ) {
    this.connection = new Connection(engineUrl("session", { token }, "ws"), {
      event: (event) => this.onEvent(event),
      binary: (message) => this.show(message),
      link: (link) => this.noteLink(link),
    });
    this.graft = new Graft({
      state: this.state,
      ask: (request) => this.ask(request),
      attempt: (request) => this.attempt(request),
      request: (request) => this.connection.request(request),
      note: (problem, remedy = "", offered, of) =>
        this.tell("note", { problem, location: "", remedy }, { of, topic: "graft", offer: this.offerOfPage(offered) }),
      positionsOf: (mesh) => this.viewport.surfaceOf(mesh)?.rest,
    });
    this.marking = new Marking({
      ask: (request) => this.ask(request),
      note: (problem, remedy = "") => this.tell("note", { problem, location: "", remedy }, { topic: "marked" }),
      hideMarks: () => this.viewport.hideMarks(),
    });
    this.mending = new Mending({
      state: this.state,
      marking: this.marking,
      ask: (request) => this.ask(request),
      note: (problem) => this.tell("note", { problem, location: "", remedy: "" }, { of: "repair", topic: "mended" }),
    });
    this.printing = new Printing({
      state: this.state,
      marking: this.marking,
      ask: (request) => this.ask(request),
      up: () => this.viewport.navigation.axes()[2].toArray(),
      showPart: (name) => this.graft.showPart(name),
    });
    this.folders = new Folders({
      welcome: this.welcome,
      attempt: (request) => this.attempt(request),
      ask: (request) => this.ask(request),
      note: (problem, remedy, offered) =>
        this.tell("note", { problem, location: "", remedy }, { topic: "written", offer: this.offerOfPage(offered) }),
      tellFiles: (done, outcome) => this.tellFiles(done, outcome),
    });
    this.library = new Library((request) => this.connection.send(request));
    effect(() => this.rememberDocument());
    effect(() => this.followFolder());
    effect(() => {
      void this.view.up.value;
      queueMicrotask(() => void this.printing.renew()); // after the viewport has turned its axes
    });
  }

  start(): void {
    this.connection.open();
  }

  /** Sends a request to the engine. If the engine refuses it, tells the user and resolves with undefined. */
  async ask(request: PageRequest): Promise<Outcome | undefined> {
    const answer = await this.attempt(request);
    if (!("code" in answer)) {
      if (request.do === "part") this.tellOfFiles(answer);
      return answer;
    }
    const isToldAlready = answer.code === "cancelled" || this.link.value === "lost";
    const told = laterStepWords(answer, this.state.value) ?? toldOf(answer);
    if (!isToldAlready) this.tell("problem", told, { of: request.do, offer: this.offerFor(answer, request) });
    return undefined;
  }

  /** Offers what the page can do about a failure, such as a wider tolerance where a vertex lacks a mirror image. */
  private offerFor(failure: Failure, refused: PageRequest): Message["offer"] {
    const tolerance = sufficientTolerance(failure);
    if (tolerance === undefined) return this.offerOf(failure, refused);
    const run = async () => {
      mirrorTolerance.value = tolerance;
      for (const request of withTolerance(refused, tolerance, this.state.value?.symmetry?.plane))
        if ((await this.ask(request)) === undefined) return;
    };
    return { label: `Use ${formatNumber(asPercent(tolerance))} %`, run: () => void run() };
  }
  private offerOf(fact: Failure | Note, refused?: PageRequest): Message["offer"] {
    const remedy = "id" in fact ? remedyOf(fact, refused) : undefined;
    return remedy && { label: remedy.label, run: () => void remedy.run(this) };
  }
  /** Grafts the part that was grafted last once more, on the other side. */
  mirrorGraft(): Promise<void> {
    return mirrorLatestGraft(this, this.viewport);
  }
  /** Turns symmetry on, between left and right in the middle of the model, or off. */
  async setSymmetry(on: boolean): Promise<void> {
    if (!on) return void (await this.ask({ do: "symmetry", plane: null }));
    const box = this.box.value;
    const plane = box && planeAcross(nearestAxis(this.viewport.navigation.axes()[1].toArray()), box);
    await this.ask({ do: "symmetry", ...(plane && { plane }), tolerance_rel: mirrorTolerance.value });
  }

  /**
   * Undoes or redoes one change. If that removes the active handle, the last remaining one becomes active. If it brings
   * a handle back, that handle becomes active.
   */
  async undoOrRedo(direction: "undo" | "redo"): Promise<void> {
    const handles = () => (this.state.value?.handles ?? []).map(({ name }) => name);
    const before = handles();
    const active = this.tools.activeHandle.value;
    const answer = await this.attempt({ do: direction });
    if ("code" in answer && answer.code !== "usage") this.tell("problem", toldOf(answer), { offer: this.offerOf(answer) }); // usage: nothing is left
    if ("code" in answer || this.graft.mode.value === "graft") return;
    const after = handles();
    const back = after.filter((name) => !before.includes(name));
    const isGone = active !== null && !after.includes(active);
    const next = back.at(-1) ?? (isGone ? after.at(-1) : undefined);
    if (next !== undefined) this.tools.activeHandle.value = next;
  }

  /** Sends a request to the engine. Resolves with its answer or with the reason why it failed. */
  async attempt(request: PageRequest): Promise<Outcome | Failure> {
    const { id, answer } = this.connection.send(request);
    this.setWork(id, { id, label: labelOf(request), since: performance.now() });
    const { value: before } = this.state;
    try {
      const outcome = await answer;
      this.dismissOutdated(request.do);
      this.announce(announcementOf(request, outcome, before));
      return outcome;
    } catch (failure) {
      if (failure instanceof Refusal) return failure.error;
      if (failure instanceof LostConnection) return noAnswer;
      throw failure;
    } finally {
      this.setWork(id, undefined);
    }
  }

  /** Returns whether every request has been answered. */
  isIdle(): boolean {
    return this.working.value.size === 0;
  }

  /** The folder of the open file, or undefined if the file is not on the engine's machine. */
  get openedFolder(): string | undefined {
    const { value: opened } = this.opened;
    return opened !== undefined && "path" in opened && opened.path !== undefined ? folderOf(opened.path) : undefined;
  }

  /** Opens a model, and remembers it in case the connection is lost. */
  async open(request: OpenRequest): Promise<boolean> {
    const before = this.opened.value;
    this.opened.value = undefined; // states that arrive before the answer may belong to either document
    const asked = this.ask(request);
    this.library.pauseFor(asked.then(() => this.viewport.modelVisible));
    const done = await asked;
    this.opened.value = done === undefined ? before : request;
    if (done === undefined) return false;
    this.dialog.value = null;
    this.tools.shapeReach.value = null; // another model may have another size
    this.dismissMessages();
    this.tellOfFiles(done);
    if (this.state.value !== null) this.announce(openedWords(this.state.value));
    rememberOpened(request);
    return true;
  }

  /** Opens a model like `open`, but asks first what to do with unsaved work. */
  openInstead(request: OpenRequest): void {
    const name = baseName(request.path ?? request.sample ?? "it");
    this.confirmThenOpen({ name, open: () => this.open(request) });
  }
  confirmThenOpen(pending: PendingOpen): void {
    if (this.unsaved.value) this.pendingOpen.value = pending;
    else void pending.open();
  }
  /** Opens the document that waited for the user's decision. */
  openPending(): void {
    const { value: pending } = this.pendingOpen;
    this.pendingOpen.value = null;
    void pending?.open();
  }
  /** Saves first. Asks for the location if there is none yet. */
  async saveThenOpenPending(): Promise<void> {
    if (await this.save()) this.openPending();
    // A message gives the reason.
    else if (this.dialog.value !== "save" && this.replacing.value === null) this.pendingOpen.value = null;
  }

  /** Opens the first model of the command line, with the other ones as parts. An edit file is opened without parts. */
  async openGiven([path, ...others]: readonly string[]): Promise<void> {
    if (path === undefined) return;
    const isEdit = (file: string) => file.endsWith(".json");
    const parts = isEdit(path) ? [] : others.filter((file) => !isEdit(file));
    const opened = await this.open({ do: "open", path, ...(parts.length > 0 ? { parts } : {}) });
    if (!opened || parts.length === 0) return;
    this.graft.mode.value = "graft";
    this.graft.arrangement.value = "apart";
  }

  /**
   * Sends handle poses during a drag. `isShown`: the vertex shader shows them already. Then the engine need only stream
   * the exact frame, unless a heat map is shown.
   */
  drag(poses: Poses, isShown = false): void {
    const answered = this.viewport.beginPoseRequest();
    const frames = isShown && this.view.heatMap.value === "none" ? "exact" : "all";
    this.connection.request({ do: "drag", poses, frames }).then(
      (outcome) => answered("pose" in outcome ? (outcome.pose ?? 0) : 0),
      () => answered(0),
    );
  }

  /** Sends the final poses of handles. */
  async pose(poses: Record<string, Pose>): Promise<Outcome | undefined> {
    const answered = this.viewport.beginPoseRequest();
    const outcome = await this.ask({ do: "pose", poses });
    answered(outcome !== undefined && "pose" in outcome ? (outcome.pose ?? 0) : 0);
    return outcome;
  }

  /** Writes the edit file. Asks for the location if there is none yet. Resolves with whether it was written. */
  async save(): Promise<boolean> {
    if (this.state.value === null) return false;
    if (this.state.value.edit === "") {
      this.dialog.value = "save";
      return false;
    }
    const done = await this.attempt({ do: "save" });
    if (!("code" in done)) {
      this.tellFiles("Saved", done);
      return true;
    }
    const file = fileToReplace(done);
    if (file !== undefined) this.replacing.value = file;
    else this.tell("problem", toldOf(done), { of: "save", offer: this.offerOf(done, { do: "save" }) });
    return false;
  }
  /** Overwrites the edit file that another program or tab has changed. */
  async replace(): Promise<void> {
    const { value: edit } = this.replacing;
    this.replacing.value = null;
    if (edit === null) return;
    const done = await this.ask({ do: "save", edit, overwrite: true });
    if (done === undefined) return;
    this.tellFiles("Saved", done);
    this.openPending();
  }

  /** Ends the work for the program that waits for it. */
  async done(): Promise<void> {
    if ((await this.ask({ do: "done" })) === undefined) return;
    this.handedBack.value = true;
    this.connection.close();
    window.close(); // browsers do that only with a tab that a page has opened
  }

  /** Asks for the file to export an object to: the model, unless a name is given. */
  askToExport(name = ""): void {
    this.toExport.value = name;
    this.dialog.value = "export";
  }

  /** Shapes a region, and tells what the engine notes on it. */
  async shape(request: Extract<PageRequest, { do: "sculpt" }>): Promise<void> {
    const answer = await this.ask(request);
    const problem = answer === undefined ? undefined : shapedWords(answer);
    if (problem !== undefined) this.tell("note", { problem, location: "", remedy: "" }, { of: "sculpt", topic: "shaped" });
  }

  /** Changes the colour of a group and nothing else. */
  recolour(name: string, colour: string): Promise<Outcome | undefined> {
    return this.ask({ do: "group", name, colour, keep: true });
  }

  cancel(id?: Id): void {
    const request: PageRequest = id === undefined ? { do: "cancel" } : { do: "cancel", of: id };
    this.connection.request(request).then(
      (outcome) => this.announce(announcementOf(request, outcome, this.state.value)),
      () => undefined, // the request has ended
    );
  }

  /** Undoes the change whose set-up is still running in the background. */
  async cancelSetUp(): Promise<void> {
    await this.attempt({ do: "cancel", of: null }); // refused if the set-up has just finished
  }

  /** Tells screen readers what the eye sees. */
  announce(words: string | undefined): void {
    if (words !== undefined) this.announced.value = words;
  }

  /** Removes all messages. Returns whether there were any. */
  dismissMessages(): boolean {
    const had = this.messages.value.length > 0;
    this.messages.value = [];
    return had;
  }
  /** Removes messages about refusals that a later success, an undo, a redo or a reset has made obsolete. */
  private dismissOutdated(done: Message["of"]): void {
    const goesBack = done === "undo" || done === "redo" || done === "reset";
    const isOutdated = ({ of }: Message) => of !== undefined && (of === done || (goesBack && !fileRequests.has(of)));
    if (this.messages.value.some(isOutdated))
      this.messages.value = this.messages.value.filter((message) => !isOutdated(message));
  }
  tell(kind: Message["kind"], told: Told, more: Pick<Message, "of" | "topic" | "offer"> = {}): void {
    const message = { key: ++this.lastMessage, kind, told, ...more };
    this.messages.value = withMessage(this.messages.value, message);
  }
  note(problem: string, location = "", remedy = "", offered?: PageRemedy): void {
    this.tell("note", { problem, location, remedy }, { offer: this.offerOfPage(offered) });
  }
  private offerOfPage(offered: PageRemedy | undefined): Message["offer"] {
    const remedy = offered && remedyOfPage[offered];
    return remedy && { label: remedy.label, run: () => void remedy.run(this) };
  }
  dismiss(key: number): void {
    this.messages.value = this.messages.value.filter((message) => message.key !== key);
  }

  /** Reports the files that were written and the engine's notes on them. */
  tellFiles(done: string, outcome: Outcome): void {
    ++this.filesWritten.value;
    const files = (outcome.files ?? []).map((file) => (typeof file === "string" ? file : file.name));
    const remedy = (outcome.notes ?? []).map(noteWords).join("\n");
    this.tell("note", { problem: done, location: files.join("\n"), remedy }, { topic: "written" });
  }

  // Reports on files that were opened or added as parts. A message that has a remedy stays until the user closes it.
  private tellOfFiles({ notes = [] }: Outcome): void {
    for (const note of notes) {
      const { problem, remedy } = toldOfNote(note);
      const lines = [...(note.details ?? []).map(noteWords), remedy].filter((line) => line !== "");
      const told = { problem, location: "", remedy: lines.join("\n") };
      if (note.id === "editor.defects") this.tell("note", told, { of: "repair", topic: "defects", offer: this.offerOfMending() });
      else this.tell("note", told, { offer: this.offerOf(note) });
    }
  }

  private offerOfMending(): Message["offer"] {
    if (!this.mending.defective.value.some(({ findings }) => findings.some(({ repairable }) => repairable))) return undefined;
    return { label: "Mend all", run: () => void this.mending.mendAll(this.mending.defective.value.map(({ name }) => name)) };
  }

  private onEvent(event: EngineEvent): void {
    switch (event.event) {
      case "welcome":
        this.folders.onWelcome(event); // before a model of such a folder is opened
        if (this.welcome.value === null) this.openAtStart(event.models);
        this.welcome.value = event;
        if (this.reopening !== undefined) void this.reopen(this.reopening.to);
        break;
      case "state":
        batch(() => {
          this.state.value = event;
          this.selected.value = event.selected;
          this.view.setFileUnit(unitsOfFiles[event.unit]);
          const active = this.tools.activeHandle;
          if (active.value !== null && !event.handles.some((handle) => handle.name === active.value))
            active.value = null;
          this.graft.onState(event);
          if (this.marking.onState(event)) {
            this.printing.forget();
            this.tools.measured.value = null;
            ++this.tools.modelChanges.value;
          }
        });
        this.viewport.setDocument(event);
        break;
      case "progress":
        this.noteProgress(event);
        break;
      case "live":
        this.noteLive(event);
        break;
      case "graft":
        this.graft.onEvent(event);
        break;
      case "offer-restore":
        if (this.reopening !== undefined) this.restoring = this.restoreAtOnce(event, this.reopening.since);
        else this.offer.value = event;
        break;
      case "notice":
        this.tell("problem", inPanelWords(event.error), { offer: this.offerOf(event.error) });
        break;
    }
  }

  private noteProgress(event: Event<"progress">): void {
    if (event.of !== null && !this.working.value.has(event.of)) return; // the request has been answered meanwhile
    const all = new Map(this.progress.value);
    if (event.fraction >= 1) all.delete(String(event.of));
    else all.set(String(event.of), event);
    this.progress.value = all;
  }

  private setWork(id: Id, work: RunningRequest | undefined): void {
    const all = new Map(this.working.value);
    if (work !== undefined) all.set(id, work);
    else all.delete(id);
    const progress = new Map(this.progress.value);
    batch(() => {
      this.working.value = all;
      if (work === undefined && progress.delete(String(id))) this.progress.value = progress;
    });
  }

  private noteLive(event: Event<"live">): void {
    const { error: _, ...before } = this.live.value;
    const anew = event.stage === "starting";
    if (anew) {
      this.setupBegan = performance.now();
      this.setupSeconds.value = undefined;
    }
    const isSet = event.stage === "exact" || event.stage === "ready" || event.stage === "proxy-only";
    if (isSet && this.setupBegan !== undefined) {
      this.setupSeconds.value = (performance.now() - this.setupBegan) / 1000;
      this.setupBegan = undefined;
    }
    this.live.value = anew ? event : { ...before, ...event };
    if (event.error !== undefined) this.tell("problem", inPanelWords(event.error), { of: "live", offer: this.offerOf(event.error) });
    else if (event.accuracy !== undefined) this.dismissOutdated("live");
    if (event.stage === "ready" || event.stage === "failed" || event.stage === "proxy-only") {
      const progress = new Map(this.progress.value);
      if (progress.delete("null")) this.progress.value = progress;
    }
  }

  private noteLink(link: Link): void {
    if (link === "lost" && this.link.value !== "lost") {
      const { value: state } = this.state;
      const { value: opened } = this.opened;
      const to = state !== null && opened !== undefined ? this.requestToReopen(state, opened) : undefined;
      this.bringsBack.value = this.unsaved.value;
      if (state !== null) this.reopening = { to, since: "Reconnected." };
      this.progress.value = new Map();
      void this.checkToken();
    }
    // For the user the connection stays lost until it is open again.
    if (link === "connecting" && this.welcome.value !== null) return;
    if (link === "open") this.expired.value = false;
    this.link.value = link;
    if (link === "lost") void this.checkToken();
  }

  /** Checks whether the token is still valid. A WebSocket gives no reason for a refusal, but a plain request does. */
  private async checkToken(): Promise<void> {
    try {
      const answer = await fetch(engineUrl("session", { token: this.token }), { cache: "no-store" });
      this.expired.value = answer.status === 403;
    } catch {
      this.expired.value = false; // no server answers
    }
  }

  /** Reopens the document that was open before a reload, or else opens the files of the command line. */
  private openAtStart(models: readonly string[]): void {
    const before = openBeforeReload();
    if (before === undefined) void this.openGiven(models);
    else this.reopening = { to: before, since: "The page was reloaded." };
  }

  // If all changes are saved, the edit file contains them. Otherwise the journal of the opened file does.
  private requestToReopen({ dirty, edit, graft }: DocumentState, opened: OpenRequest): OpenRequest {
    return !dirty && edit !== "" ? { do: "open", path: edit, ...(graft !== null && { resume: true }) } : opened;
  }

  /** Reopens the document after a lost connection or a reload. */
  private async reopen(to: OpenRequest | undefined): Promise<void> {
    const { reopening } = this;
    if (to !== undefined && (await this.ask(to)) !== undefined) this.opened.value = to;
    await this.restoring;
    if (this.reopening !== reopening) return; // the connection was lost again
    await this.graft.withdrawLeftOver();
    this.reopening = this.restoring = undefined;
    this.bringsBack.value = false;
  }

  private async restoreAtOnce(offer: Event<"offer-restore">, since: string): Promise<void> {
    this.bringsBack.value = true;
    const done = await this.ask({ do: "restore" });
    if (done !== undefined) this.note(since, "", `Restored ${counted(offer.changes, "change")}.`);
    else if (this.link.value === "open") this.offer.value = offer; // the message says why; the user may try again
  }

  /** Takes the unit of the folder, or of the dropped file, that the open document is from, and the model's up axis. */
  private followFolder(): void {
    const { value: opened } = this.opened;
    if (opened === undefined) return;
    const upload = opened.upload === undefined ? undefined : keyOfUpload(opened.upload);
    this.view.folder.value = this.openedFolder ?? upload ?? "samples";
    this.view.model.value = opened.path ?? upload ?? `sample ${opened.sample ?? ""}`;
  }

  /** Remembers the open document for a reload, and whether it has unsaved changes, restored or not, for the lists. */
  private rememberDocument(): void {
    const { value: opened } = this.opened;
    const { value: state } = this.state;
    if (opened === undefined || state === null) return;
    const isUnsaved = this.unsaved.value || this.offer.value !== null;
    untracked(() => rememberUnsaved(opened, isUnsaved));
    rememberOpen(this.requestToReopen(state, opened));
  }

  private show(message: BinaryMessage): void {
    this.viewport.show(message);
    this.graft.onMessage(message);
    this.library.onMessage(message);
    if (message.kind === MessageKind.selection) this.selected.value = message.indices("vertices")?.length ?? 0;
    const model = this.viewport.main;
    if (message.kind === MessageKind.mesh && message.header.role !== "part" && model !== undefined)
      this.box.value = boxOf(model);
  }
}

function boxOf({ box, offset }: Surface): Box {
  const inModel = (at: Surface["box"]["min"]): Vector => [at.x + offset[0], at.y + offset[1], at.z + offset[2]];
  return { low: inModel(box.min), high: inModel(box.max) };
}
