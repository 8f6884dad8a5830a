import { Plane, Quaternion, Vector3 } from "three";
import type { Editor } from "../app/editor";
import type { Viewport } from "../view/viewport";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import { Gesture, type Act, type Axis, type Grip, type Steps } from "./gesture";
import { partAt, type Layout, type Part } from "./gizmo_layout";
import { GizmoView } from "./gizmo_view";
import type { Movable, Moved } from "./movable";
import { axesOf, centreOf, poseOf, withPivot, withPivotAt, type Placement } from "./pose_math";
import type { Status } from "./status";

/**
 * The gesture in progress on the active handle. A `modal` gesture begins by a key and ends by a click; others are
 * drags.
 */
interface Going {
  readonly name: string;
  readonly start: Placement;
  readonly axes: Quaternion;
  readonly gesture: Gesture | undefined; // undefined: the pivot is dragged
  readonly modal: boolean;
  spaces: number; // how often the key of the axis was pressed
}

/** Moves, turns and scales the active handle in one widget: nine degrees of freedom and a pivot. */
export class Gizmo {
  private readonly view: GizmoView;
  private layout: Layout | undefined;
  private hovered: string | undefined;
  private going: Going | undefined;
  private readonly hidden = new Set<string>();
  private hiddenAsOf = "";
  private snapsOnce = false;

  constructor(
    private readonly editor: Editor,
    private readonly viewport: Viewport,
    private readonly control: Movable,
    private readonly camera: ScreenCamera,
    private readonly status: Status,
  ) {
    this.view = new GizmoView(viewport.overlay, camera);
    viewport.onFrame.add(() => this.draw());
  }

  get isGoing(): boolean {
    return this.going !== undefined;
  }
  get isModal(): boolean {
    return this.going?.modal === true;
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

  leave(): void {
    if (this.hovered !== undefined) this.viewport.requestRender();
    this.hovered = undefined;
  }

  /** Begins a drag if a part is under the pointer. Returns whether it did. */
  press(screenPoint: ScreenPoint, generosity: number): boolean {
    const handle = this.control.active;
    const part = this.partUnder(screenPoint, generosity);
    if (handle === undefined || part === undefined) return false;
    if (this.editor.tools.movesPivot.value) this.beginPivot(handle);
    else this.begin(handle, part.grip, screenPoint, false);
    return true;
  }

  /** Begins a gesture by a key. */
  beginModal(act: Act, screenPoint: ScreenPoint): void {
    const handle = this.control.active;
    if (handle === undefined || this.control.acts?.includes(act) === false) return;
    if (this.going !== undefined) this.cancel();
    this.begin(handle, { act, axis: "free" }, screenPoint, true);
    this.follow(screenPoint, false);
  }

  follow(screenPoint: ScreenPoint, snapsOnce: boolean): void {
    const { going } = this;
    if (going === undefined) return;
    this.snapsOnce = snapsOnce;
    if (going.gesture === undefined) return this.dragPivot(going, screenPoint);
    going.gesture.pointAt(screenPoint);
    this.showGesture(going.name, going.gesture);
  }

  /** Ends the gesture and keeps its result. */
  end(): void {
    const { going } = this;
    if (going === undefined) return;
    this.going = undefined;
    const handle = this.control.active;
    this.status.clear();
    this.viewport.requestRender();
    if (handle === undefined || handle.name !== going.name) return;
    if (isSame(handle.placement, going.start, handle.defaultPivot)) this.control.revert(going.name, going.start);
    else void this.control.commit(going.name, handle.placement);
  }

  /** Reverts the handle to its placement before the gesture. */
  cancel(): void {
    const { going } = this;
    if (going === undefined) return;
    this.going = undefined;
    this.status.clear();
    this.control.revert(going.name, going.start);
  }

  /** Handles a key during a gesture: an axis, a number, another act. Returns whether the key was one of these. */
  takeKey({ key, shiftKey, ctrlKey, metaKey, altKey }: KeyboardEvent): boolean {
    const { going } = this;
    if (going?.gesture === undefined || metaKey || altKey) return false;
    const { gesture } = going;
    const axis = "xyz".indexOf(key.toLowerCase());
    if (key.length === 1 && axis >= 0 && !ctrlKey) this.constrain(going, axis as Axis, shiftKey);
    else if (!gesture.number.press(key)) return this.changeAct(going, key, ctrlKey || shiftKey);
    this.showGesture(going.name, gesture);
    return true;
  }

  /** Moves the pivot back to the centre of the handle boundary. */
  resetPivot(): void {
    const handle = this.control.active;
    if (handle !== undefined) void this.control.commit(handle.name, withPivot(handle.placement, handle.defaultPivot));
  }

  private partUnder(screenPoint: ScreenPoint, generosity = 1): Part | undefined {
    if (this.layout === undefined || this.control.active === undefined) return undefined;
    if (!this.editor.tools.movesPivot.value) return partAt(this.layout, screenPoint, generosity);
    const { centre, parts } = this.layout;
    const isNear = Math.hypot(centre.x - screenPoint.x, centre.y - screenPoint.y) <= 14 * generosity;
    return isNear ? parts.find(({ kind }) => kind === "ball") : undefined;
  }

  private begin(handle: Moved, grip: Grip, screenPoint: ScreenPoint, modal: boolean): void {
    const { name, placement } = handle;
    const axes = this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    const gesture = new Gesture(grip, placement, axes, this.camera, screenPoint);
    this.going = { name, start: placement, axes, gesture, modal, spaces: 0 };
    this.viewport.requestRender();
  }

  private beginPivot({ name, placement }: Moved): void {
    const axes = this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    this.going = { name, start: placement, axes, gesture: undefined, modal: false, spaces: 0 };
  }

  // Moves the pivot on the surface if it is under the pointer, otherwise in the screen plane.
  private dragPivot({ name, start }: Going, screenPoint: ScreenPoint): void {
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
    this.status.say(gesture.label(unit === "none" ? "" : unit), gesture.pointer);
  }

  private steps(): Steps {
    const { snapMove, snapTurnDeg, snapScale } = this.editor.tools;
    const diagonal = this.editor.state.value?.model.diagonal ?? 1;
    return { move: snapMove.value || diagonal / 100, turnDeg: snapTurnDeg.value, scale: snapScale.value };
  }

  // Pressing an axis key once uses the gizmo's space, twice the other space, three times frees the gesture again.
  private constrain(going: Going, axis: Axis, across: boolean): void {
    const { gesture } = going;
    if (gesture === undefined) return;
    const { act } = gesture.doing;
    const isSame = gesture.doing.axis === axis && (gesture.doing.across ?? false) === across;
    going.spaces = isSame ? going.spaces + 1 : 1;
    const own = this.editor.tools.gizmoSpace.value;
    const space = going.spaces === 2 ? (own === "local" ? "world" : "local") : own;
    const axes = this.axesFor(going.start, space);
    const grip: Grip = going.spaces > 2 ? { act, axis: "free" } : { act, axis, across: across && act !== "turn" };
    if (going.spaces > 2) going.spaces = 0;
    this.going = { ...going, axes };
    gesture.constrain(grip, axes);
  }

  private changeAct(going: Going, key: string, isOther: boolean): boolean {
    const act = ({ g: "move", r: "turn", s: "scale" } as const)[key.toLowerCase() as "g"];
    if (act === undefined || this.control.acts?.includes(act) === false || isOther || going.gesture === undefined || !going.modal) return false;
    going.gesture.constrain({ act, axis: "free" }, going.axes);
    this.showGesture(going.name, going.gesture);
    return true;
  }

  private axesFor(placement: Placement, space: "local" | "world"): Quaternion {
    return space === "local" ? axesOf(placement) : new Quaternion();
  }

  private draw(): void {
    const handle = this.control.active;
    if (handle === undefined || this.viewport.settings.before.value) {
      this.layout = undefined;
      return this.view.hide();
    }
    const { placement } = handle;
    const { going } = this;
    const axes = going?.axes ?? this.axesFor(placement, this.editor.tools.gizmoSpace.value);
    const gesture = going?.gesture && { gesture: going.gesture, from: centreOf(going.start), axes };
    this.layout = this.view.draw({
      centre: centreOf(placement),
      axes,
      hovered: this.hovered,
      gesture,
      movesPivot: this.editor.tools.movesPivot.value,
      acts: this.control.acts,
      isHidden: (part) => this.hidden.has(part.id),
    });
    if (going === undefined && this.layout !== undefined) this.findHidden(this.layout);
  }

  // Finds the parts that the model hides, while the view is at rest.
  private findHidden(layout: Layout): void {
    const firsts = layout.parts.flatMap(({ outline }) => outline.slice(0, 1));
    const asOf = firsts.map(({ x, y }) => `${x.toFixed(0)},${y.toFixed(0)}`).join(" ");
    if (asOf === this.hiddenAsOf || this.viewport.navigation.isMoving) return;
    this.hiddenAsOf = asOf;
    this.hidden.clear();
    for (const part of layout.parts) {
      if (part.kind === "ring" || part.kind === "ball" || part.axis === "free") continue;
      const screenPoint = this.camera.project(part.place);
      const point = this.viewport.pick(screenPoint.x, screenPoint.y)?.point;
      const towardsCamera = this.camera.towards(part.place);
      if (point !== undefined && point.sub(part.place).dot(towardsCamera) < -4 * this.camera.worldPerPixel(part.place))
        this.hidden.add(part.id);
    }
    if (this.hidden.size > 0) this.viewport.requestRender();
  }
}

// Compares poses rather than maps, because a rotation of 720° is not the identity.
function isSame(a: Placement, b: Placement, defaultPivot: Vector3): boolean {
  const told = (placement: Placement) => JSON.stringify(poseOf(placement, defaultPivot));
  return told(a) === told(b) && a.pivot.equals(b.pivot);
}
