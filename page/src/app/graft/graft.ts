import { batch, computed, signal } from "@preact/signals";
import { MessageKind, type BinaryMessage } from "../../engine/binary_message";
import type { Outcome } from "../../engine/connection";
import type { DocumentState, Matrix4 } from "../../protocol";
import {
  pairsField, readStep, withFields, withPair,
  type MatchRef, type GraftFields, type GraftStep, type Pair,
} from "./graft_step";
import { GraftStarts } from "./graft_starts";
import { seamOf, type Seam } from "./seam";
import { noteWords } from "../wording";
import * as hovering from "./hovering";
import { closingFields, keptFields, otherSide, type Cut, type CutClosing, type CutRequest, type DrawnCurve, type Side } from "../cuts";
import type {
  Arrangement, GraftHost, GraftReport, GraftTool, LoopRef, PartSource, SelectionChange, ShownLoop, MeshObject,
} from "./graft_types";
import { LoopCurve } from "./loop_curve";
import { Throttled } from "../throttled";

export type * from "./graft_types";

/** Holds the parts, their loops and the current graft as signals for the panel and the view, and changes them. */
export class Graft {
  readonly mode = signal<"deform" | "graft">("deform");
  readonly tool = signal<GraftTool>("loops");
  readonly arrangement = signal<Arrangement>("result");
  readonly loops = signal<ReadonlyMap<number, readonly ShownLoop[]>>(new Map());
  readonly hovered = signal<LoopRef | null>(null);
  /** The match (or start) that the Delete key removes. */
  readonly activeMatch = signal<MatchRef | null>(null);
  readonly cutPlane = signal<Cut | null>(null);
  /** How the next cut by a plane is closed. */
  readonly cutClosing = signal<CutClosing>({ cap: "open" });
  readonly cutCurve = signal<DrawnCurve | null>(null);
  /** The last cut, until another change follows. */
  readonly lastCut = signal<CutRequest | null>(null);
  /** The part that a click or a drag drops on the surface. */
  readonly dropped = signal<{ name: string; isNew: boolean } | null>(null);
  /** Tells which part is being dropped on the surface, and therefore not shown beside the model. */
  readonly isBeingDropped = signal<((name: string) => boolean) | null>(null);
  /** The loop clicked first, which the next click pairs. */
  readonly picked = signal<LoopRef | null>(null);
  readonly activePair = signal(0);
  /** The binary message of the latest graft result. */
  readonly preview = signal<BinaryMessage | null>(null);
  readonly report = signal<GraftReport | null>(null);
  /** The seam of the latest result that was not dragged. */
  readonly seam = signal<Seam | null>(null);
  /** All fields of the graft that was edited last. */
  readonly latestStep = signal<GraftFields | null>(null);
  /** Fields that a slider or the pointer changes for now, on top of the document's. */
  readonly dragged = signal<GraftFields | null>(null);
  /** Map from the part's coordinates to its pose on the target, before it deforms. */
  readonly transform = signal<Matrix4 | null>(null);
  /** Parts whose visibility the user has set, by name. */
  readonly shownParts = signal<ReadonlyMap<string, boolean>>(new Map());

  readonly model = computed((): MeshObject | undefined => {
    const state = this.host.state.value;
    return state === null ? undefined : { ...state.model, grafted: false };
  });
  readonly parts = computed((): readonly MeshObject[] => this.host.state.value?.parts ?? []);
  readonly objects = computed((): readonly MeshObject[] => [
    ...(this.model.value === undefined ? [] : [this.model.value]),
    ...this.parts.value,
  ]);
  /** The graft step of the document. */
  readonly kept = computed((): GraftStep | undefined => {
    const graft = this.host.state.value?.graft ?? null;
    return graft === null ? undefined : readStep(graft.step);
  });
  /** Whether a graft is edited. The engine then refuses other changes of the model. */
  readonly isEdited = computed(() => this.kept.value !== undefined);
  /** The graft step as shown: the document's, with the dragged fields on top. */
  readonly step = computed((): GraftStep | undefined => {
    const { value: kept } = this.kept;
    const { value: dragged } = this.dragged;
    if (dragged === null) return kept;
    const base =
      kept ?? readStep({ source: dragged.source, target: dragged.target ?? this.model.value?.name });
    return withFields(base, dragged);
  });
  readonly source = computed(() => this.byName(this.step.value?.source));
  readonly target = computed(() => this.byName(this.step.value?.target));
  /** The given pairs, or the only possible pair if source and target have one loop each. */
  readonly pairs = computed(() => this.pairsOf(this.step.value));
  readonly keptPairs = computed(() => this.pairsOf(this.kept.value));
  private pairsOf(step: GraftStep | undefined): readonly Pair[] {
    if (step === undefined || step.at !== undefined) return [];
    if (step.pairs.length > 0) return step.pairs;
    const single = this.source.value?.loops === 1 && this.target.value?.loops === 1;
    return single ? [{ sourceLoop: 0, targetLoop: 0, matches: [] }] : [];
  }

  /** Holds the start and the twist of each pair. */
  readonly starts: GraftStarts = new GraftStarts(this);

  private readonly drags = new Throttled<GraftFields>((fields) => this.sendDrag(fields));
  private readonly requestedLoops = new Set<number>(); // meshes whose loops were requested
  private accepting: Promise<void> | undefined;
  private newest = 0; // number of the newest graft that the engine reported

  constructor(private readonly host: GraftHost) {}

  byName(name: string | undefined): MeshObject | undefined {
    return this.objects.value.find((object) => object.name === name);
  }
  /** Returns the name of a mesh in requests, or undefined for the model. */
  nameOf(mesh: number): string | undefined {
    return mesh === this.model.value?.mesh ? undefined : this.byMesh(mesh)?.name;
  }
  byMesh(mesh: number): MeshObject | undefined {
    return this.objects.value.find((object) => object.mesh === mesh);
  }
  /** Returns whether a part is shown. A grafted part is hidden by default, unless it is the current source. */
  isShown(part: MeshObject): boolean {
    return this.shownParts.value.get(part.name) ?? (!part.grafted || part.name === this.step.value?.source);
  }
  /** Meshes shown as themselves in graft mode: all except those that the shown result replaces. */
  readonly shownMeshes = computed((): ReadonlySet<number> => {
    const parts = this.parts.value.filter((part) => this.isShown(part) && this.isBeingDropped.value?.(part.name) !== true);
    const meshes = new Set([this.model.value?.mesh ?? -1, ...parts.map((part) => part.mesh)]);
    const { value: arrangement } = this.arrangement;
    const hasPreview = this.preview.value !== null;
    // A dropped part is shown only on the surface, even before the result is known.
    const lands = this.step.value?.at !== undefined && this.report.value?.error === undefined;
    if (hasPreview && arrangement !== "apart") meshes.delete(this.target.value?.mesh ?? -1);
    if ((hasPreview || lands) && arrangement === "result") meshes.delete(this.source.value?.mesh ?? -1);
    return meshes;
  });
  /** Returns whether a step made the part by dividing another object. */
  isHalf(part: MeshObject): boolean {
    return (this.host.state.value?.steps ?? []).some(({ kind, fields }) => kind === "cut" && (fields as { result?: string }).result === part.name);
  }
  toggleShown(part: MeshObject): void {
    this.shownParts.value = new Map(this.shownParts.value).set(part.name, !this.isShown(part));
  }

  /** Shows a part beside the model, where parts are shown. */
  showPart(name: string): void {
    const part = this.byName(name);
    this.mode.value = "graft";
    if (part !== undefined && !this.isShown(part)) this.toggleShown(part);
  }

  /** Adds a part beside the model, and grafts it if both have one loop. Resolves with the part's name. */
  async addPart(source: PartSource, start = true): Promise<string | undefined> {
    const done = await this.host.ask({ do: "part", what: "add", ...source });
    if (done?.name === undefined) return undefined;
    if (start) await this.startWith(done.name);
    return done.name;
  }

  /** Grafts a part if it and the model have one loop each. Otherwise shows both apart, so that loops can be clicked. */
  async startWith(name: string): Promise<void> {
    const part = this.byName(name);
    const { value: model } = this.model;
    if (part === undefined || model === undefined || this.isEdited.value) return;
    if (part.loops === 1 && model.loops === 1) await this.startAlone(name);
    else this.arrangement.value = "apart";
  }

  private async startAlone(name: string): Promise<void> {
    this.arrangement.value = "result";
    await this.set({ source: name });
  }

  /** Changes the graft of the document, or starts one. `withPart`: its part was added for it. */
  async set(fields: GraftFields, withPart = false): Promise<boolean> {
    const starts = !this.isEdited.value;
    this.drags.forget();
    const done = await this.host.ask({ do: "graft", ...fields, ...(withPart && { with_part: true }) });
    batch(() => {
      this.dragged.value = null;
      if (done?.transform !== undefined) this.transform.value = done.transform;
      if (done !== undefined && starts && this.arrangement.value === "apart") this.arrangement.value = "both";
    });
    return done !== undefined;
  }

  /**
   * Previews the result. While a request is on its way only the newest fields wait; they are sent when it is answered.
   */
  drag(fields: GraftFields): void {
    this.dragged.value = { ...this.dragged.value, ...fields };
    this.drags.send(this.dragged.value);
  }
  /** Commits the dragged fields to the document. */
  async keepDragged(): Promise<boolean> {
    const { value: dragged } = this.dragged;
    return dragged !== null && this.set(dragged);
  }
  /** Reverts to the graft of the document. */
  async forgetDragged(): Promise<void> {
    this.drags.forget();
    this.dragged.value = null;
    await this.host.request({ do: "graft-drag" }).catch(() => undefined);
    this.transform.value = this.report.value?.transform ?? null;
  }

  /**
   * Begins to drop a part, which from now on is shown on the surface only. `add` opens the part. Resolves with its
   * name.
   */
  async beginDrop(add: () => Promise<string | undefined>): Promise<string | undefined> {
    const before = new Set(this.parts.value.map((part) => part.name));
    this.isBeingDropped.value = (part) => !before.has(part);
    const name = await add();
    batch(() => {
      this.isBeingDropped.value = name === undefined ? null : (part) => part === name;
      if (name === undefined) return;
      this.arrangement.value = "result";
      this.tool.value = "drop";
      this.dropped.value = { name, isNew: !before.has(name) };
    });
    if (this.dropped.value?.isNew === true) hovering.remember(this.dropped.value.name);
    return name;
  }
  /** Grafts the dropped part. A part that was opened for the drop is added by the same change. */
  async endDrop(fields: GraftFields): Promise<void> {
    const { value: dropped } = this.dropped;
    this.dropped.value = null;
    await this.set(fields, dropped?.isNew === true);
    this.isBeingDropped.value = null;
    hovering.forget();
  }
  /** Cancels the drop. A part that was opened for it is removed. */
  async cancelDrop(): Promise<void> {
    const { value: dropped } = this.dropped;
    this.dropped.value = null;
    await this.forgetDragged();
    if (dropped?.isNew === true && this.host.state.value?.undo === "add_part")
      await this.host.ask({ do: "part", what: "withdraw", name: dropped.name });
    this.isBeingDropped.value = null;
    hovering.forget();
  }
  /** Takes back a part that was over the surface when the page was reloaded. */
  async withdrawLeftOver(): Promise<void> {
    const name = hovering.name();
    hovering.forget();
    const state = this.host.state.value;
    if (name === "" || state?.undo !== "add_part" || this.byName(name) === undefined) return;
    await this.host.ask({ do: "part", what: "withdraw", name });
  }
  /** Cancels the drop because the part was released off the surface, and tells the user. */
  async cancelMissedDrop(): Promise<void> {
    const { name = "The part", isNew = true } = this.dropped.value ?? {};
    await this.cancelDrop();
    this.host.note(
      `${name} was released off the surface, so nothing was ${isNew ? "added" : "grafted"}`,
      "Drag it again and release it on the model.",
    );
  }

  private async sendDrag(fields: GraftFields): Promise<void> {
    const done = await this.host.request({ do: "graft-drag", ...fields }).catch(() => undefined);
    if (this.dragged.value !== null && done?.transform !== undefined) this.transform.value = done.transform;
  }

  /** Cuts by the plane or along the curve that is shown. */
  async cut(keep: Side): Promise<boolean> {
    const request = this.cutRequest(keep);
    const done = request === undefined ? undefined : await this.host.ask(request);
    if (request === undefined || done === undefined) return false;
    this.tellOfCut(request, done);
    batch(() => {
      this.lastCut.value = request;
      this.cutPlane.value = this.cutCurve.value = null;
      this.tool.value = "loops";
      if (done.name !== undefined) this.arrangement.value = "apart";
    });
    return true;
  }
  private tellOfCut({ mesh = this.model.value?.name ?? "", plane }: CutRequest, { name, notes = [] }: Outcome): void {
    const more = notes.map(noteWords);
    const [first, second] = plane === undefined ? ["inside", "outside"] : ["blue side", "red side"];
    if (name !== undefined)
      this.host.note(
        `Split into ${mesh} (${first}) and ${name} (${second})`,
        [`${name} is under Parts: hide it, export it, or make it the model.`, ...more].join(" "),
        "parts",
        "cut",
      );
    else if (more.length > 0) this.host.note("Cut.", more.join(" "), undefined, "cut");
  }
  private cutRequest(keep: Side): CutRequest | undefined {
    const { value: plane } = this.cutPlane;
    const { value: curve } = this.cutCurve;
    if (this.tool.value === "plane")
      return plane === null
        ? undefined
        : { do: "cut", mesh: this.nameOf(plane.mesh), ...keptFields(keep), plane: plane.plane, ...closingFields(this.cutClosing.value) };
    const [a, b, c, ...rest] = curve?.vertices ?? [];
    if (curve === null || a === undefined || b === undefined || c === undefined) return undefined;
    return { do: "cut", mesh: this.nameOf(curve.mesh), ...keptFields(keep), loop: [a, b, c, ...rest] };
  }
  /** Undoes the last cut and repeats it with the other side kept. */
  async cutOtherwise(): Promise<void> {
    const { value: last } = this.lastCut;
    const other = last === null ? undefined : otherSide(last);
    if (other === undefined || (await this.host.ask({ do: "undo" })) === undefined) return;
    if ((await this.host.ask(other)) !== undefined) this.lastCut.value = other;
  }

  /** Whether the fixed part of the source is being painted. Selections are then made on the source. */
  readonly paintsFixed = computed(() => this.mode.value === "graft" && this.tool.value === "fixed");

  /** Changes the selection on the part, and with it the part's fixed vertices. */
  async selectFixed(change: SelectionChange): Promise<void> {
    const mesh = this.source.value?.name;
    const done = await this.host.ask({ do: "select", mesh, ...change });
    if (done !== undefined) await this.set({ fixed: done.selected === 0 ? null : true });
  }
  /** Begins to paint fixed vertices, with those that are already fixed selected. */
  async paintFixed(): Promise<void> {
    const mesh = this.source.value?.name;
    const what = this.kept.value?.fixed ?? { indices: [] };
    if ((await this.host.ask({ do: "select", mesh, how: "set", what })) === undefined) return;
    batch(() => {
      this.tool.value = "fixed";
      this.arrangement.value = "apart";
    });
  }
  donePainting(): void {
    batch(() => {
      this.tool.value = "loops";
      this.arrangement.value = "result";
    });
  }

  /** Discards the graft in progress, and its part if it was added by dropping it. */
  cancel(): Promise<Outcome | undefined> {
    return this.host.ask({ do: "graft", what: "cancel" });
  }
  /** Finishes the graft. A second call before the answer, as by a double click, does nothing more. */
  accept(): Promise<void> {
    return (this.accepting ??= this.acceptNow().finally(() => (this.accepting = undefined)));
  }
  private async acceptNow(): Promise<void> {
    const done = await this.host.ask({ do: "accept" });
    if (done !== undefined) this.arrangement.value = "result";
  }

  /** Handles a click on a loop. The first click is remembered; a click on a loop of another object pairs the two. */
  async pick(ref: LoopRef): Promise<void> {
    const first = this.picked.value;
    if (first === null || this.byMesh(first.mesh) === undefined || first.mesh === ref.mesh) {
      this.picked.value = first?.mesh === ref.mesh && first.loop === ref.loop ? null : ref;
      return;
    }
    this.picked.value = null;
    await this.pair(first, ref);
  }

  /**
   * Pairs two loops. The object that is the current target stays the target. Without a graft in progress the model is
   * the target. The result is shown as soon as there is one. Calls run one after another. Returns whether the engine took
   * the pair.
   */
  pair(a: LoopRef, b: LoopRef): Promise<boolean> {
    const paired = this.pairing.catch(() => undefined).then(() => this.pairNow(a, b));
    this.pairing = paired;
    return paired;
  }
  private pairing: Promise<unknown> = Promise.resolve();
  private showsNextResult = false; // set by a new pair
  private async pairNow(a: LoopRef, b: LoopRef): Promise<boolean> {
    const targetName = this.kept.value?.target ?? this.model.value?.name;
    const [target, source] = this.byMesh(a.mesh)?.name === targetName ? [a, b] : [b, a];
    const names = { target: this.byMesh(target.mesh)?.name, source: this.byMesh(source.mesh)?.name };
    const same = this.kept.value?.source === names.source && this.kept.value?.target === names.target;
    const before = same && this.kept.value?.at === undefined ? (this.kept.value?.pairs ?? []) : [];
    const pairs = withPair(before, source.loop, target.loop);
    this.activePair.value = pairs.length - 1;
    const anew = same ? { at: null } : names;
    this.showsNextResult = true;
    return this.set({ ...anew, pairs: pairsField(pairs) });
  }

  setPairs(pairs: readonly Pair[]): Promise<boolean> {
    return this.set({ pairs: pairs.length > 0 ? pairsField(pairs) : null });
  }
  dragPairs(pairs: readonly Pair[]): void {
    this.drag({ pairs: pairsField(pairs) });
  }

  /** Requests the loops of all objects, once for each mesh. */
  async needLoops(): Promise<void> {
    for (const { mesh, name } of this.objects.value) {
      if (this.requestedLoops.has(mesh)) continue;
      this.requestedLoops.add(mesh);
      await this.host.attempt({ do: "loops", mesh: name });
    }
  }

  /** Handles binary messages that concern grafts. */
  onMessage(message: BinaryMessage): void {
    if (message.kind === MessageKind.graft) this.takePreview(message);
    if (message.kind === MessageKind.loops) this.takeLoops(message);
  }

  onEvent(event: GraftReport): void {
    if (event.graft < this.newest) return;
    this.newest = event.graft;
    batch(() => {
      this.report.value = event;
      if (event.error !== undefined) this.preview.value = null;
      else if (this.showsNextResult && event.seam !== undefined) {
        if (this.picked.value === null && this.hovered.value === null) this.arrangement.value = "result"; // the next pair is not begun
        this.showsNextResult = false;
      }
      if (this.dragged.value === null && event.transform !== undefined)
        this.transform.value = event.transform;
      this.starts.storeFound(event);
    });
  }

  /** Discards everything that belongs to objects missing in the engine's new state. */
  onState(state: DocumentState): void {
    const meshes = new Set([state.model.mesh, ...state.parts.map((part) => part.mesh)]);
    const known = [...this.loops.value].filter(([mesh]) => meshes.has(mesh));
    for (const mesh of this.requestedLoops) if (!meshes.has(mesh)) this.requestedLoops.delete(mesh);
    batch(() => {
      if (known.length < this.loops.value.size) this.loops.value = new Map(known);
      if (!meshes.has(this.hovered.value?.mesh ?? -1)) this.hovered.value = null;
      if (!meshes.has(this.picked.value?.mesh ?? -1)) this.picked.value = null;
      if (!meshes.has(this.cutPlane.value?.mesh ?? -1)) this.cutPlane.value = null;
      if (!meshes.has(this.cutCurve.value?.mesh ?? -1)) this.cutCurve.value = null;
      if (state.graft === null && this.dragged.value === null) this.forgetPreview();
      if (state.undo !== "cut") this.lastCut.value = null;
      if (state.graft !== null) this.latestStep.value = state.graft.step;
      if (state.graft !== null) this.mode.value = "graft";
      this.followPairs();
    });
  }
  // After an undo the active pair may be gone, and the loops that wait for a pair have to be seen again.
  private shownPairs = 0;
  private followPairs(): void {
    const { length } = this.keptPairs.value;
    if (this.activePair.value >= length) this.activePair.value = Math.max(0, length - 1);
    const waits = length > 0 && length < (this.source.value?.loops ?? 0);
    if (length < this.shownPairs && waits && this.arrangement.value === "result") this.arrangement.value = "both";
    this.shownPairs = length;
  }
  private forgetPreview(): void {
    this.preview.value = null;
    this.report.value = null;
    this.transform.value = null;
    this.activePair.value = 0;
  }

  private takePreview(message: BinaryMessage): void {
    const { graft = 0, dragged = false } = message.header;
    if (graft < this.newest || (this.host.state.value?.graft == null && !dragged)) return;
    if (dragged && this.dragged.value === null) return;
    this.newest = graft;
    this.preview.value = message;
    if (!dragged) this.seam.value = seamOf(message);
  }

  private takeLoops(message: BinaryMessage): void {
    const { mesh } = message.header;
    const vertices = message.indices("vertices") ?? new Uint32Array();
    const offsets = message.indices("offsets") ?? new Uint32Array();
    const positions = this.host.positionsOf(mesh) ?? new Float32Array();
    const shown = Array.from({ length: Math.max(0, offsets.length - 1) }, (_, i): ShownLoop => {
      const own = vertices.subarray(offsets[i], offsets[i + 1]);
      const curve = new LoopCurve(own, positions);
      return { vertices: own, length: curve.length, curve };
    });
    this.loops.value = new Map(this.loops.value).set(mesh, shown);
  }
}
