import { Plane, Quaternion, Vector3 } from "three";
import type { Editor } from "../app/editor";
import { pageBox } from "../view/page_box";
import type { Viewport } from "../view/viewport";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import { ClearBars } from "./clear_bars";
import { Gesture, ringRadiusPx, type GestureKind, type Axis, type Grip, type Steps } from "./gesture";
import { gripWords, partAt, type Layout, type Part } from "./gizmo_layout";
import { gizmoScale, gizmoShift } from "./gizmo_size";
import { GizmoView } from "./gizmo_view";
import type { Movable, Moved } from "./movable";
import { axesOf, centreOf, poseOf, withPivot, withPivotAt, type Placement } from "./pose_math";
import type { Status } from "./status";

/**
 * The gesture in progress on the active handle. A `modal` gesture begins by a key and ends by a click; others are
 * drags.
 */
interface ActiveGesture {
  readonly name: string;
  readonly start: Placement;
  readonly axes: Quaternion;
  readonly gesture: Gesture | undefined; // undefined: the pivot is dragged
  readonly modal: boolean;
  axisPresses: number; // how often the key of the axis was pressed
}

/** Moves, turns and scales the active handle in one widget: nine degrees of freedom and a pivot. */
export class Gizmo {
  private readonly view: GizmoView;
  private layout: Layout | undefined;
  private hovered: string | undefined;
  private ongoing: ActiveGesture | undefined;
  private readonly hidden = new Set<string>();
  private hiddenAsOf = "";
  /** Returns the screen points of grips beside the gizmo, which bars must not cover either. */
  otherGrips: () => readonly ScreenPoint[] = () => [];
  private snapsOnce = false;
  private scale = 1;
  private shiftedBy: ScreenPoint = { x: 0, y: 0 };
  private readonly bars: ClearBars;

  constructor(
    private readonly editor: Editor,
    private readonly viewport: Viewport,
    private readonly control: Movable,
    private readonly camera: ScreenCamera,
    private readonly status: Status,
  ) {
    this.view = new GizmoView(viewport.overlay, camera);
    this.bars = new ClearBars(() => viewport.overlay.closest<HTMLElement>(".stage-area"));
    viewport.onFrame.add(() => this.draw());
  }

  get isActive(): boolean {
    return this.ongoing !== undefined;
  }
  get isModal(): boolean {
    return this.ongoing?.modal === true;
  }
  /** The size of the gizmo, × the usual one. */
  get size(): number {
    return this.scale;
  }
  /** How far the gizmo is drawn from its centre, in pixels. */
  get shift(): ScreenPoint {
    return this.shiftedBy;
  }
  get centre(): ScreenPoint | undefined {
    return this.layout?.centre;
  }

  /** Highlights the part that a press would take. Returns whether there is one. */
  hover(screenPoint: ScreenPoint): boolean {
    const part = this.partUnder(screenPoint);
    const id = part?.id;
    if (id !== this.hovered) this.viewport.requestRender();
    this.hovered = id;
    return part !== undefined;
  }

  /** Names the grip at a point; undefined if there is none, or a gesture goes on. */
  wordsAt(screenPoint: ScreenPoint): string | undefined {
    const part = this.ongoing === undefined ? this.partUnder(screenPoint, 1.5) : undefined;
    return part === undefined ? undefined : gripWords(part);
  }

  leave(): void {
    if (this.hovered !== undefined) this.viewport.requestRender();
    this.hovered = undefined;
  }

  /** Begins a drag if a part is under the pointer. Returns whether it did. */
  press(screenPoint: ScreenPoint, toleranceFactor: number): boolean {
    const handle = this.control.active;
    const part = this.partUnder(screenPoint, toleranceFactor);
    if (handle === undefined || part === undefined) return false;
    if (this.editor.tools.movesPivot.value) this.beginPivot(handle);
    else this.begin(handle, part.grip, this.atCentre(screenPoint), false);
    return true;
  }

  /** Begins a gesture by a key. */
  beginModal(kind: GestureKind, screenPoint: ScreenPoint): void {
    const handle = this.control.active;
    if (handle === undefined || this.control.gestureKinds?.includes(kind) === false) return;
    if (this.ongoing !== undefined) this.cancel();
    this.begin(handle, { kind, axis: "free" }, this.atCentre(screenPoint), true);
    this.follow(screenPoint, false);
  }

  follow(screenPoint: ScreenPoint, snapsOnce: boolean): void {
    const { ongoing } = this;
    if (ongoing === undefined) return;
    this.snapsOnce = snapsOnce;
    if (ongoing.gesture === undefined) return this.dragPivot(ongoing, screenPoint);
    ongoing.gesture.pointAt(this.atCentre(screenPoint));
    this.showGesture(ongoing.name, ongoing.gesture);
  }

  /** Ends the gesture and keeps its result. */
  end(): void {
    const { ongoing } = this;
    if (ongoing === undefined) return;
    this.ongoing = undefined;
    const handle = this.control.active;
    this.status.clear();
    this.viewport.requestRender();
    if (handle === undefined || handle.name !== ongoing.name) return;
    if (isSame(handle.placement, ongoing.start, handle.defaultPivot)) this.control.revert(ongoing.name, ongoing.start);
    else void this.control.commit(ongoing.name, handle.placement);
  }

  /** Reverts the handle to its placement before the gesture. */
  cancel(): void {
    const { ongoing } = this;
    if (ongoing === undefined) return;
    this.ongoing = undefined;
    this.status.clear();
    this.control.revert(ongoing.name, ongoing.start);
  }

  /** Handles a key during a gesture: an axis, a number, another gesture. Returns whether the key was one of these. */
  takeKey({ key, shiftKey, ctrlKey, metaKey, altKey }: KeyboardEvent): boolean {
    const { ongoing } = this;
    if (ongoing?.gesture === undefined || metaKey || altKey) return false;
    const { gesture } = ongoing;
    const axis = "xyz".indexOf(key.toLowerCase());
    if (key.length === 1 && axis >= 0 && !ctrlKey) this.constrain(ongoing, axis as Axis, shiftKey);
    else if (!gesture.number.press(key)) return this.changeKind(ongoing, key, ctrlKey || shiftKey);
    this.showGesture(ongoing.name, gesture);
    return true;
  }

  /** Moves the pivot back to the centre of the handle boundary. */
  resetPivot(): void {
    const handle = this.control.active;
    if (handle !== undefined) void this.control.commit(handle.name, withPivot(handle.placement, handle.defaultPivot));
  }

  /** Returns where the pointer would be if the gizmo were drawn at its centre. */
  private atCentre({ x, y }: ScreenPoint): ScreenPoint {
    return { x: x - this.shiftedBy.x, y: y - this.shiftedBy.y };
  }

  private partUnder(screenPoint: ScreenPoint, toleranceFactor = 1): Part | undefined {
    if (this.layout === undefined || this.control.active === undefined) return undefined;
    if (!this.editor.tools.movesPivot.value) return partAt(this.layout, screenPoint, toleranceFactor);
    const { centre, parts } = this.layout;
    const isNear = Math.hypot(centre.x - screenPoint.x, centre.y - screenPoint.y) <= 14 * toleranceFactor;
    return isNear ? parts.find(({ kind }) => kind === "ball") : undefined;
  }

  private begin(handle: Moved, grip: Grip, screenPoint: ScreenPoint, modal: boolean): void {
    const { name, placement } = handle;
    const axes = this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    const gesture = new Gesture(grip, placement, axes, this.camera, screenPoint, this.scale * ringRadiusPx);
    this.ongoing = { name, start: placement, axes, gesture, modal, axisPresses: 0 };
    this.viewport.requestRender();
  }

  private beginPivot({ name, placement }: Moved): void {
    const axes = this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    this.ongoing = { name, start: placement, axes, gesture: undefined, modal: false, axisPresses: 0 };
  }

  // Moves the pivot on the surface if it is under the pointer, otherwise in the screen plane.
  private dragPivot({ name, start }: ActiveGesture, screenPoint: ScreenPoint): void {
    const centre = centreOf(start);
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.camera.towards(centre), centre);
    const on = this.viewport.pick(screenPoint.x, screenPoint.y)?.point;
    const at = on ?? this.camera.rayAt(screenPoint).intersectPlane(plane, new Vector3());
    if (at === null) return;
    this.control.show(name, withPivotAt(start, at));
    this.status.say(on === undefined ? "Pivot" : "Pivot on the surface", screenPoint);
  }

  private showGesture(name: string, gesture: Gesture): void {
    gesture.steps = this.editor.tools.snap.value !== this.snapsOnce ? this.steps() : undefined;
    const unit = this.viewport.settings.unit.value;
    this.control.show(name, gesture.placement());
    const { x, y } = gesture.pointer;
    this.status.say(gesture.label(unit === "none" ? "" : unit), { x: x + this.shiftedBy.x, y: y + this.shiftedBy.y });
  }

  private steps(): Steps {
    const { snapMove, snapTurnDeg, snapScale } = this.editor.tools;
    const diagonal = this.editor.state.value?.model.diagonal ?? 1;
    return { move: snapMove.value || diagonal / 100, turnDeg: snapTurnDeg.value, scale: snapScale.value };
  }

  // Pressing an axis key once uses the gizmo's space, twice the other space, three times frees the gesture again.
  private constrain(ongoing: ActiveGesture, axis: Axis, across: boolean): void {
    const { gesture } = ongoing;
    if (gesture === undefined) return;
    const { kind } = gesture.currentGrip;
    const isSame = gesture.currentGrip.axis === axis && (gesture.currentGrip.across ?? false) === across;
    ongoing.axisPresses = isSame ? ongoing.axisPresses + 1 : 1;
    const own = this.editor.tools.gizmoSpace.value;
    const space = ongoing.axisPresses === 2 ? (own === "local" ? "world" : "local") : own;
    const axes = this.axesFor(ongoing.start, space);
    const grip: Grip = ongoing.axisPresses > 2 ? { kind, axis: "free" } : { kind, axis, across: across && kind !== "turn" };
    if (ongoing.axisPresses > 2) ongoing.axisPresses = 0;
    this.ongoing = { ...ongoing, axes };
    gesture.constrain(grip, axes);
  }

  private changeKind(ongoing: ActiveGesture, key: string, isOther: boolean): boolean {
    const kind = ({ g: "move", r: "turn", s: "scale" } as const)[key.toLowerCase() as "g"];
    if (kind === undefined || this.control.gestureKinds?.includes(kind) === false) return false;
    if (isOther || ongoing.gesture === undefined || !ongoing.modal) return false;
    ongoing.gesture.constrain({ kind, axis: "free" }, ongoing.axes);
    this.showGesture(ongoing.name, ongoing.gesture);
    return true;
  }

  private axesFor(placement: Placement, space: "local" | "world"): Quaternion {
    return space === "local" ? axesOf(placement) : new Quaternion();
  }

  private draw(): void {
    const handle = this.control.active;
    if (handle === undefined || this.viewport.settings.before.value) {
      this.layout = undefined;
      this.hiddenAsOf = "";
      this.bars.release();
      return this.view.hide();
    }
    const { placement } = handle;
    const { ongoing } = this;
    const axes = ongoing?.axes ?? this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    const gesture = ongoing?.gesture && { gesture: ongoing.gesture, from: centreOf(ongoing.start), axes };
    if (ongoing === undefined) this.fit(handle);
    this.layout = this.view.draw({
      centre: centreOf(placement),
      axes,
      scale: this.scale,
      shift: this.shiftedBy,
      hovered: this.hovered,
      gesture,
      movesPivot: this.editor.tools.movesPivot.value,
      gestureKinds: this.control.gestureKinds,
      isHidden: (part) => this.hidden.has(part.id),
    });
    if (ongoing === undefined && this.layout !== undefined) this.findHidden(this.layout);
  }

  /** Fits the gizmo to what it moves, and into the view. */
  private fit({ placement, radius }: Moved): void {
    const { canvas } = this.viewport;
    this.scale = gizmoScale({
      movedPx: radius === undefined ? undefined : radius / this.camera.worldPerPixel(centreOf(placement)),
      viewWidth: canvas.clientWidth,
      viewHeight: canvas.clientHeight,
      isCoarse: matchMedia("(pointer: coarse)").matches,
    });
    const centre = this.camera.project(centreOf(placement));
    const stays = this.editor.tools.movesPivot.value || centre.behind;
    this.shiftedBy = stays ? { x: 0, y: 0 } : gizmoShift(centre, this.scale, pageBox(canvas));
  }

  // Finds the parts that the model hides, and moves bars off the others, while the view is at rest.
  private findHidden(layout: Layout): void {
    const firsts = layout.parts.flatMap(({ outline }) => outline.slice(0, 1));
    const points = firsts.map(({ x, y }) => `${x.toFixed(0)},${y.toFixed(0)}`);
    const asOf = [...points, this.bars.sizes].join(" ");
    if (asOf === this.hiddenAsOf || this.viewport.navigation.isMoving) return;
    this.hiddenAsOf = asOf;
    this.bars.keepOff([...layout.parts.flatMap(({ outline }) => outline), ...this.otherGrips()]);
    this.hidden.clear();
    for (const part of layout.parts) {
      if (part.kind === "ring" || part.kind === "ball" || part.axis === "free") continue;
      const screenPoint = this.camera.project(part.position);
      const point = this.viewport.pick(screenPoint.x, screenPoint.y)?.point;
      const towardsCamera = this.camera.towards(part.position);
      if (point !== undefined && point.sub(part.position).dot(towardsCamera) < -4 * this.camera.worldPerPixel(part.position))
        this.hidden.add(part.id);
    }
    if (this.hidden.size > 0) this.viewport.requestRender();
  }
}

// Compares poses rather than maps, because a rotation of 720° is not the identity.
function isSame(a: Placement, b: Placement, defaultPivot: Vector3): boolean {
  const text = (placement: Placement) => JSON.stringify(poseOf(placement, defaultPivot));
  return text(a) === text(b) && a.pivot.equals(b.pivot);
}
