import { effect } from "@preact/signals";
import { Box3, Matrix4, Vector3 } from "three";
import type { Editor } from "../app/editor";
import type { Handle } from "../protocol";
import type { Surface } from "../view/surface/surface";
import type { Viewport } from "../view/viewport";
import type { GraphStore } from "./graph_store";
import { atRest, isRedrawn, matrixOf, mirrored, placementOf, poseOf, type Placement, type Plane } from "./pose_math";

/** The handle that the gizmo is attached to. */
export interface ActiveHandle {
  readonly name: string;
  readonly placement: Placement;
  readonly defaultPivot: Vector3;
  /** Size of the region around it, as a length along edges; undefined: it has no region of its own. */
  readonly reach: number | undefined;
  readonly vertices: Uint32Array;
  /** Radius of its vertices around their centre, at rest. */
  readonly radius: number;
}

/** A handle that the engine has not confirmed yet. It can be dragged at once. */
interface Painted {
  readonly pivot: Vector3;
  readonly vertices: Uint32Array;
}

/** Makes handles and moves them. Shows a pose at once, asks the engine to stream it, and commits it to the document. */
export class HandleControl {
  private readonly painted = new Map<string, Painted>();
  /** The handle and placement of the gesture in progress. */
  private dragged: { name: string; placement: Placement } | undefined;
  /** Placements sent to the engine, until the document has them. */
  private readonly asked = new Map<string, Placement>();
  /** Pivots of sheared handles, which the document cannot store. */
  private readonly pivots = new Map<string, Vector3>();
  private readonly radii = new WeakMap<Uint32Array, number>();
  private isScheduled = false; // whether `showDragged` is scheduled for the next animation frame

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

  /** Returns the names of all handles, including those that the engine has not confirmed yet. */
  get names(): string[] {
    const known = this.editor.state.value?.handles.map(({ name }) => name) ?? [];
    return [...new Set([...known, ...this.painted.keys()])];
  }

  /** Returns the plane of symmetry, if there is one. */
  get plane(): Plane | undefined {
    const plane = this.editor.state.value?.symmetry?.plane;
    if (plane === undefined) return undefined;
    return { point: new Vector3(...plane.point), normal: new Vector3(...plane.normal).normalize() };
  }

  activate(name: string | null): void {
    this.editor.tools.activeHandle.value = name;
    this.viewport.requestRender();
  }

  /** Returns the name of the handle that contains a vertex. */
  handleAt(surface: Surface, vertex: number): string | undefined {
    for (const [name, vertices] of surface.handles) if (vertices.includes(vertex)) return name;
    return undefined;
  }

  /** Makes a handle of these vertices. Its gizmo appears at once, while the engine still sets up. */
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

  /** Makes a handle of the selected vertices. */
  async addSelected(): Promise<void> {
    const surface = this.viewport.main;
    if (surface === undefined) return;
    const vertices: number[] = [];
    surface.selection.forEach((is, v) => is !== 0 && vertices.push(v));
    if (vertices.length === 0) return;
    await this.paint(surface, Uint32Array.from(vertices));
    void this.editor.ask({ do: "select", how: "set", what: { indices: [] } });
  }

  /** Shows a temporary placement of a handle in the next picture, and asks the engine to stream it. */
  show(name: string, placement: Placement): void {
    this.dragged = { name, placement };
    if (!this.isScheduled) requestAnimationFrame(() => this.showDragged());
    this.isScheduled = true;
    this.viewport.requestRender(); // requested after `showDragged`, so that the picture has the surface at the handle
  }

  // Does nothing if the gesture has ended meanwhile, because the placement is then outdated.
  private showDragged(): void {
    const { dragged, active: handle } = this;
    this.isScheduled = false;
    if (dragged === undefined || handle === undefined || handle.name !== dragged.name) return;
    const isShown = this.showAtOnce(handle.name, dragged.placement);
    const pose = poseOf(dragged.placement, handle.defaultPivot);
    this.editor.tools.dragged.value = { handle: handle.name, pose };
    this.editor.drag({ [handle.name]: pose }, isShown);
  }

  /** Commits the placement of a handle to the document. */
  async commit(name: string, placement: Placement): Promise<void> {
    const handle = this.active;
    if (handle === undefined || handle.name !== name) return;
    this.dragged = undefined; // `tools.dragged` stays until the document has the pose
    this.asked.set(name, placement);
    this.pivots.set(name, placement.pivot.clone());
    this.showAtOnce(name, placement);
    await this.editor.pose({ [name]: poseOf(placement, handle.defaultPivot) });
    if (this.asked.get(name) === placement) this.asked.delete(name);
    if (this.dragged === undefined) this.editor.tools.dragged.value = null;
    this.viewport.requestRender();
  }

  /**
   * Reverts a handle to its pose in the document. Sends a drag without poses at once, so that the document's state is
   * shown even if an undo comes just before or after.
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

  /**
   * Shows a placement by the vertex shader. Returns whether it is shown. A redrawn curve is shown only when the engine
   * streams it.
   */
  private showAtOnce(name: string, placement: Placement): boolean {
    return !isRedrawn(placement) && this.viewport.showPoses(this.mapsBy(name, placement));
  }

  /** Returns the maps of a handle and of its twin beyond the plane of symmetry. */
  private mapsBy(name: string, placement: Placement): Map<string, Matrix4> {
    const maps = new Map([[name, matrixOf(placement)]]);
    const { plane } = this;
    const twin = this.editor.state.value?.symmetry?.twins.find(({ of }) => of === name);
    if (plane !== undefined && twin !== undefined) maps.set(twin.name, matrixOf(mirrored(placement, plane)));
    return maps;
  }

  /** Returns the placement of a handle that the document does not have yet. */
  private ahead(name: string): Placement | undefined {
    return this.dragged?.name === name ? this.dragged.placement : this.asked.get(name);
  }

  private ofPainted(name: string, painted: Painted | undefined): ActiveHandle | undefined {
    if (painted === undefined) return undefined;
    const placement = this.ahead(name) ?? atRest(painted.pivot);
    const { pivot, vertices } = painted;
    return { name, placement, defaultPivot: pivot, reach: undefined, vertices, radius: this.radiusOf(vertices) };
  }

  private ofDocument(handle: Handle, surface: Surface): ActiveHandle | undefined {
    const at = handle.pivot ?? handle.centre;
    if (at === undefined) return undefined;
    const defaultPivot = new Vector3(...at);
    const pose = handle.matrix === undefined ? handle.pose : { matrix: handle.matrix };
    const known = placementOf(pose, defaultPivot);
    if (known === undefined) return undefined;
    const pivot = this.pivots.get(handle.name);
    const vertices = surface.handles.get(handle.name) ?? new Uint32Array();
    const isSheared = known.kind === "affine" && !isRedrawn(known);
    const asTold = isSheared && pivot !== undefined ? { ...known, pivot } : known;
    return {
      name: handle.name,
      placement: this.ahead(handle.name) ?? asTold,
      defaultPivot,
      reach: handle.reach,
      vertices,
      radius: this.radiusOf(vertices),
    };
  }

  /** Returns the centre of the handle boundary at rest, which is also the engine's default pivot. */
  private pivotOf(surface: Surface, vertices: Uint32Array): Vector3 {
    const boundary = this.graphs.of(surface)?.boundaryOf(vertices) ?? vertices;
    const sum = new Vector3();
    const position = new Vector3();
    for (const v of boundary) sum.add(position.fromArray(surface.rest, 3 * v));
    return sum.divideScalar(boundary.length).applyMatrix4(new Matrix4().setPosition(...surface.offset));
  }

  /** Returns half the diagonal of the box of vertices at rest. */
  private radiusOf(vertices: Uint32Array): number {
    const known = this.radii.get(vertices);
    const surface = this.viewport.main;
    if (known !== undefined || surface === undefined) return known ?? 0;
    const box = new Box3();
    const position = new Vector3();
    for (const v of vertices) box.expandByPoint(position.fromArray(surface.rest, 3 * v));
    const radius = box.isEmpty() ? 0 : 0.5 * box.getSize(position).length();
    this.radii.set(vertices, radius);
    return radius;
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
