import { effect } from "@preact/signals";
import { Matrix4, Vector3 } from "three";
import type { Editor } from "../app/editor";
import type { Handle } from "../protocol";
import type { Surface } from "../view/surface/surface";
import type { Viewport } from "../view/viewport";
import type { GraphStore } from "./graph_store";
import { atRest, isRedrawn, matrixOf, mirrored, placementOf, poseOf, type Placement, type Plane } from "./pose_math";

/** The handle that the gizmo is at. */
export interface ActiveHandle {
  readonly name: string;
  readonly placement: Placement;
  readonly defaultPivot: Vector3;
  /** How far the region around it goes, along edges; undefined: it has none of its own. */
  readonly reach: number | undefined;
  readonly vertices: Uint32Array;
}

/** A handle that the engine has not told of yet: it can be dragged at once. */
interface Painted {
  readonly pivot: Vector3;
  readonly vertices: Uint32Array;
}

/** Makes handles and moves them: what is shown at once, what the engine streams, and what the document has in the end. */
export class HandleControl {
  private readonly painted = new Map<string, Painted>();
  /** Where a gesture that goes on has a handle. */
  private dragged: { name: string; placement: Placement } | undefined;
  /** Where handles are by what the engine is asked for, until the document has it. */
  private readonly asked = new Map<string, Placement>();
  /** Pivots of sheared handles, which the document has no place for. */
  private readonly pivots = new Map<string, Vector3>();
  private isScheduled = false; // what is dragged, for the next picture

  constructor(
    private readonly editor: Editor,
    private readonly viewport: Viewport,
    private readonly graphs: GraphStore,
  ) {
    effect(() => this.followDocument());
  }

  get active(): ActiveHandle | undefined {
    const name = this.editor.tools.activeHandle.value;
    const surface = this.viewport.main;
    if (name === null || surface === undefined) return undefined;
    const painted = this.painted.get(name);
    const handle = this.editor.state.value?.handles.find((known) => known.name === name);
    if (handle !== undefined) return this.ofDocument(handle, surface) ?? this.ofPainted(name, painted);
    return this.ofPainted(name, painted);
  }

  /** All handles' names: of the document, and those to come. */
  get names(): string[] {
    const known = this.editor.state.value?.handles.map(({ name }) => name) ?? [];
    return [...new Set([...known, ...this.painted.keys()])];
  }

  /** The plane of symmetry, if there is one. */
  get plane(): Plane | undefined {
    const plane = this.editor.state.value?.symmetry?.plane;
    if (plane === undefined) return undefined;
    return { point: new Vector3(...plane.point), normal: new Vector3(...plane.normal).normalize() };
  }

  activate(name: string | null): void {
    this.editor.tools.activeHandle.value = name;
    this.viewport.requestRender();
  }

  /** The handle that holds a vertex. */
  handleAt(surface: Surface, vertex: number): string | undefined {
    for (const [name, vertices] of surface.handles) if (vertices.includes(vertex)) return name;
    return undefined;
  }

  /** Makes a handle of these vertices. Its gizmo is there at once, while the engine still sets up. */
  async paint(surface: Surface, vertices: Uint32Array): Promise<void> {
    const held = new Set<number>();
    for (const others of surface.handles.values()) for (const v of others) held.add(v);
    const own = vertices.filter((v) => !held.has(v));
    await this.add(surface, own.length > 0 ? own : vertices, (name) =>
      this.editor.ask({ do: "paint-handle", vertices: [...vertices], name }),
    );
  }

  /** Makes a handle along a path of vertices, in their order. */
  async addCurve(surface: Surface, path: Uint32Array, closed: boolean): Promise<void> {
    const reach = 0.15 * surface.box.diagonal;
    await this.add(surface, path, (name) =>
      this.editor.ask({
        do: "handle", what: "add", name, shape: "curve", closed, select: { indices: [...path] }, reach,
      }),
    );
  }

  /** Makes a handle of what is selected. */
  async addSelected(): Promise<void> {
    const surface = this.viewport.main;
    if (surface === undefined) return;
    const vertices: number[] = [];
    surface.selection.forEach((is, v) => is !== 0 && vertices.push(v));
    if (vertices.length === 0) return;
    await this.paint(surface, Uint32Array.from(vertices));
    void this.editor.ask({ do: "select", how: "set", what: { indices: [] } });
  }

  /** Where a handle is for now: in the next picture, and by what the engine streams. */
  show(name: string, placement: Placement): void {
    this.dragged = { name, placement };
    if (!this.isScheduled) requestAnimationFrame(() => this.showDragged());
    this.isScheduled = true;
    this.viewport.requestRender(); // after it, so that the picture has the surface where the handle is
  }

  // The gesture may have ended meanwhile: then this is not newer.
  private showDragged(): void {
    const { dragged, active: handle } = this;
    this.isScheduled = false;
    if (dragged === undefined || handle === undefined || handle.name !== dragged.name) return;
    const isShown = this.showAtOnce(handle.name, dragged.placement);
    const pose = poseOf(dragged.placement, handle.defaultPivot);
    this.editor.tools.dragged.value = { handle: handle.name, pose };
    this.editor.drag({ [handle.name]: pose }, isShown);
  }

  /** Where a handle is from now on. */
  async commit(name: string, placement: Placement): Promise<void> {
    const handle = this.active;
    if (handle === undefined || handle.name !== name) return;
    this.dragged = undefined; // its numbers stay until the document has them
    this.asked.set(name, placement);
    this.pivots.set(name, placement.pivot.clone());
    this.showAtOnce(name, placement);
    await this.editor.pose({ [name]: poseOf(placement, handle.defaultPivot) });
    if (this.asked.get(name) === placement) this.asked.delete(name);
    if (this.dragged === undefined) this.editor.tools.dragged.value = null;
    this.viewport.requestRender();
  }

  /**
   * Puts a handle back to where the document has it. Asked for at once and without a pose: whatever is taken back just
   * before or after it, the picture is the document's.
   */
  revert(name: string): void {
    this.forgetDragged();
    const handle = this.active;
    const isShown = handle?.name === name && this.showAtOnce(name, handle.placement);
    this.editor.drag({}, isShown);
    this.viewport.requestRender();
  }

  resetPose(): void {
    const handle = this.active;
    if (handle !== undefined) void this.commit(handle.name, atRest(handle.defaultPivot));
  }

  remove(): void {
    const handle = this.active;
    if (handle === undefined) return;
    this.activate(null);
    void this.editor.ask({ do: "handle", what: "remove", name: handle.name });
  }

  private forgetDragged(): void {
    this.dragged = undefined;
    this.editor.tools.dragged.value = null;
  }

  private async add(surface: Surface, vertices: Uint32Array, ask: (name: string) => Promise<unknown>): Promise<void> {
    const name = this.freeName();
    this.painted.set(name, { vertices, pivot: this.pivotOf(surface, vertices) });
    this.activate(name);
    const done = await ask(name);
    this.painted.delete(name);
    if (done === undefined && this.editor.tools.activeHandle.value === name) this.activate(null);
    this.viewport.requestRender();
  }

  /** Whether the surface is shown there: a redrawn curve is where the engine streams it. */
  private showAtOnce(name: string, placement: Placement): boolean {
    return !isRedrawn(placement) && this.viewport.showPoses(this.mapsBy(name, placement));
  }

  /** What moves with a handle: itself, and its twin beyond the plane of symmetry. */
  private mapsBy(name: string, placement: Placement): Map<string, Matrix4> {
    const maps = new Map([[name, matrixOf(placement)]]);
    const { plane } = this;
    const twin = this.editor.state.value?.symmetry?.twins.find(({ of }) => of === name);
    if (plane !== undefined && twin !== undefined) maps.set(twin.name, matrixOf(mirrored(placement, plane)));
    return maps;
  }

  /** Where a handle is while the document does not have it yet. */
  private ahead(name: string): Placement | undefined {
    return this.dragged?.name === name ? this.dragged.placement : this.asked.get(name);
  }

  private ofPainted(name: string, painted: Painted | undefined): ActiveHandle | undefined {
    if (painted === undefined) return undefined;
    const placement = this.ahead(name) ?? atRest(painted.pivot);
    return { name, placement, defaultPivot: painted.pivot, reach: undefined, vertices: painted.vertices };
  }

  private ofDocument(handle: Handle, surface: Surface): ActiveHandle | undefined {
    const at = handle.pivot ?? handle.centre;
    if (at === undefined) return undefined;
    const defaultPivot = new Vector3(...at);
    const pose = handle.matrix === undefined ? handle.pose : { matrix: handle.matrix };
    const known = placementOf(pose, defaultPivot);
    if (known === undefined) return undefined;
    const pivot = this.pivots.get(handle.name);
    const isSheared = known.kind === "affine" && !isRedrawn(known);
    const asTold = isSheared && pivot !== undefined ? { ...known, pivot } : known;
    return {
      name: handle.name,
      placement: this.ahead(handle.name) ?? asTold,
      defaultPivot,
      reach: handle.reach,
      vertices: surface.handles.get(handle.name) ?? new Uint32Array(),
    };
  }

  /** The centre of the rim, at rest: where the engine has it, too. */
  private pivotOf(surface: Surface, vertices: Uint32Array): Vector3 {
    const rim = this.graphs.of(surface)?.rim(vertices) ?? vertices;
    const sum = new Vector3();
    const place = new Vector3();
    for (const v of rim) sum.add(place.fromArray(surface.rest, 3 * v));
    return sum.divideScalar(rim.length).applyMatrix4(new Matrix4().setPosition(...surface.offset));
  }

  private freeName(): string {
    const taken = new Set([...this.names, ...(this.editor.state.value?.groups.map(({ name }) => name) ?? [])]);
    for (let number = 1; ; ++number) if (!taken.has(`handle ${number}`)) return `handle ${number}`;
  }

  private followDocument(): void {
    const { activeHandle } = this.editor.tools;
    const name = activeHandle.value;
    const state = this.editor.state.value;
    const isGone = state?.handles.every((handle) => handle.name !== name) ?? true;
    if (name !== null && isGone && !this.painted.has(name)) activeHandle.value = null;
    if (this.dragged !== undefined && !this.names.includes(this.dragged.name)) this.forgetDragged();
    this.viewport.requestRender();
  }
}
