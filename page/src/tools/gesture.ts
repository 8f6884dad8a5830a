// A translation, rotation or scaling of a handle, from the movement of the pointer or a typed number.
import { Plane as ThreePlane, Quaternion, Vector3 } from "three";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import { NumberEntry } from "./number_entry";
import { centreOf, moved, scaled, turned, type Placement } from "./pose_math";

export type Axis = 0 | 1 | 2;
export type GestureKind = "move" | "turn" | "scale";

/**
 * The motion of a gesture. It goes along (or about) one of the gizmo's axes, or across it (in the plane of the two
 * others). A free gesture moves in the screen plane, turns about the line of sight, or scales uniformly.
 */
export interface Grip {
  readonly kind: GestureKind;
  readonly axis: Axis | "free";
  readonly across?: boolean;
}

/** Step sizes to snap to. */
export interface Steps {
  readonly move: number;
  readonly turnDeg: number;
  readonly scale: number;
}

const leastScale = 0.01; // the least factor by a drag; smaller and negative ones can be typed
const leastTypedScale = 1e-3; // flatter handles have no shape to come back to
const leastRadiusPx = 40; // keeps a scaling stable that starts near the centre
const edgeOn = 0.2; // cosine below which a ring's plane is too oblique to locate the pointer in

export class Gesture {
  readonly number = new NumberEntry();
  /** Step sizes to snap to; undefined: no snapping. */
  steps: Steps | undefined;
  private first: ScreenPoint;
  private last: ScreenPoint;
  private turnDeg = 0;
  private readonly centre: Vector3;

  /** `axes`: a rotation whose columns are the gizmo's axes. The pointer starts at `screenPoint`. */
  constructor(
    private grip: Grip,
    readonly start: Placement,
    private axes: Quaternion,
    private readonly camera: ScreenCamera,
    screenPoint: ScreenPoint,
    private readonly ringPx = ringRadiusPx, // radius of the gizmo's rings
  ) {
    this.centre = centreOf(start);
    this.first = this.last = screenPoint;
  }

  get pointer(): ScreenPoint {
    return this.last;
  }

  get currentGrip(): Grip {
    return this.grip;
  }

  pointAt(screenPoint: ScreenPoint): void {
    if (this.grip.kind === "turn") this.turnDeg += this.turnBetween(this.last, screenPoint);
    this.last = screenPoint;
  }

  /** Restricts the gesture to another axis, starting again from where the gesture began. */
  constrain(grip: Grip, axes: Quaternion): void {
    this.grip = grip;
    this.axes = axes;
    this.turnDeg = grip.kind === "turn" ? this.turnBetween(this.first, this.last) : 0;
  }

  /** Returns the placement of the handle under this gesture. */
  placement(): Placement {
    switch (this.grip.kind) {
      case "move":
        return moved(this.start, this.shift());
      case "turn":
        return turned(this.start, { axis: this.turnAxis(), angleDeg: this.angleDeg() });
      case "scale":
        return scaled(this.start, this.factors(), this.axes);
    }
  }

  /** Describes the gesture in words: "Rotate about X  30.0°". */
  label(unit: string): string {
    const typed = this.number.text === "" ? "" : `  [${this.number.text}]`;
    const name = this.grip.axis === "free" ? "" : "XYZ".charAt(this.grip.axis);
    const digits = (value: number) => (Math.abs(value) >= 100 ? value.toFixed(1) : value.toPrecision(3));
    if (this.grip.kind === "turn") {
      const angle = this.angleDeg();
      const turns = Math.abs(angle) >= 360 ? ` (${(angle / 360).toFixed(2)} turns)` : "";
      return `Rotate${name && ` about ${name}`}  ${angle.toFixed(1)}°${turns}${typed}`;
    }
    const where = name && (this.grip.across === true ? ` across ${name}` : ` along ${name}`);
    if (this.grip.kind === "scale") return `Scale${where}  × ${this.factor().toFixed(3)}${this.isTooSmall() ? ", the least" : ""}${typed}`;
    const shift = this.shift();
    const length = name && this.grip.across !== true ? shift.dot(this.axisOf(this.grip.axis)) : shift.length();
    return `Move${where}  ${digits(length)}${unit && ` ${unit}`}${typed}`;
  }

  angleDeg(): number {
    return this.number.value ?? snapTo(this.turnDeg, this.steps?.turnDeg);
  }

  /** Returns the axis of a rotation, in world coordinates. */
  turnAxis(): Vector3 {
    return this.grip.axis === "free" ? this.camera.towards(this.centre).negate() : this.axisOf(this.grip.axis);
  }

  /** Returns the unit direction from the centre to the first pointer position, in the plane of rotation. */
  startDirection(): Vector3 {
    const axis = this.turnAxis();
    const isEdgeOn = Math.abs(axis.dot(this.camera.towards(this.centre))) < edgeOn;
    const from = isEdgeOn ? this.camera.towards(this.centre).negate() : this.pointInPlane(axis, this.first).sub(this.centre);
    from.addScaledVector(axis, -from.dot(axis));
    return from.lengthSq() < 1e-20 ? from.set(1, 0, 0).cross(axis).normalize() : from.normalize();
  }

  private axisOf(axis: Axis | "free"): Vector3 {
    return new Vector3(+(axis === 0 || axis === "free"), +(axis === 1), +(axis === 2)).applyQuaternion(this.axes);
  }

  private shift(): Vector3 {
    const typed = this.number.value;
    if (typed !== undefined) return this.axisOf(this.typedAxis()).multiplyScalar(typed);
    const { axis, across } = this.grip;
    if (axis !== "free" && across !== true) {
      const along = this.axisOf(axis);
      const length = this.parameterAlong(along, this.last) - this.parameterAlong(along, this.first);
      return along.multiplyScalar(snapTo(length, this.steps?.move));
    }
    const normal = axis === "free" ? this.camera.towards(this.centre) : this.axisOf(axis);
    const shift = this.pointInPlane(normal, this.last).sub(this.pointInPlane(normal, this.first));
    return this.steps === undefined ? shift : this.snapped(shift);
  }

  // A number typed for a plane or for the screen plane applies to the plane's first axis.
  private typedAxis(): Axis | "free" {
    return this.grip.across === true && this.grip.axis === 0 ? 1 : this.grip.across === true ? 0 : this.grip.axis;
  }

  private snapped(shift: Vector3): Vector3 {
    const inAxes = shift.clone().applyQuaternion(this.axes.clone().invert());
    const step = this.steps?.move;
    return inAxes
      .set(snapTo(inAxes.x, step), snapTo(inAxes.y, step), snapTo(inAxes.z, step))
      .applyQuaternion(this.axes);
  }

  private isTooSmall(): boolean {
    return Math.abs(this.number.value ?? 1) < leastTypedScale;
  }

  private factor(): number {
    const typed = this.number.value;
    if (typed !== undefined) return this.isTooSmall() ? leastTypedScale : typed;
    const c = this.camera.project(this.centre);
    const { axis, across } = this.grip;
    const direction = axis === "free" || across === true ? undefined : this.onPage(this.axisOf(axis));
    const distanceOf = (screenPoint: ScreenPoint) =>
      direction === undefined
        ? Math.hypot(screenPoint.x - c.x, screenPoint.y - c.y)
        : (screenPoint.x - c.x) * direction.x + (screenPoint.y - c.y) * direction.y;
    const from = distanceOf(this.first);
    const usable = Math.max(Math.abs(from), leastRadiusPx) * (from < 0 ? -1 : 1);
    const factor = 1 + (distanceOf(this.last) - from) / usable;
    const least = Math.max(leastScale, this.steps?.scale ?? 0);
    return Math.max(least, snapTo(factor, this.steps?.scale));
  }

  private factors(): Vector3 {
    const f = this.factor();
    const { axis, across } = this.grip;
    if (axis === "free") return new Vector3(f, f, f);
    const factors = across === true ? new Vector3(f, f, f) : new Vector3(1, 1, 1);
    return factors.setComponent(axis, across === true ? 1 : f);
  }

  // Returns the unit direction of an axis on the screen.
  private onPage(axis: Vector3): ScreenPoint {
    const length = 50 * this.camera.worldPerPixel(this.centre);
    const a = this.camera.project(this.centre.clone().addScaledVector(axis, -length));
    const b = this.camera.project(this.centre.clone().addScaledVector(axis, length));
    const size = Math.hypot(b.x - a.x, b.y - a.y);
    return size < 1e-6 ? { x: 1, y: 0 } : { x: (b.x - a.x) / size, y: (b.y - a.y) / size };
  }

  // Returns the position along the axis through the centre that a screen point corresponds to.
  private parameterAlong(axis: Vector3, screenPoint: ScreenPoint): number {
    const { origin, direction } = this.camera.rayAt(screenPoint);
    const cosine = axis.dot(direction);
    if (1 - cosine * cosine < 0.01) {
      const c = this.camera.project(this.centre); // the axis points at the camera: screen up counts as along
      return (c.y - screenPoint.y) * this.camera.worldPerPixel(this.centre);
    }
    const between = this.centre.clone().sub(origin);
    return (cosine * between.dot(direction) - between.dot(axis)) / (1 - cosine * cosine);
  }

  private pointInPlane(normal: Vector3, screenPoint: ScreenPoint): Vector3 {
    const plane = new ThreePlane().setFromNormalAndCoplanarPoint(normal, this.centre);
    const at = this.camera.rayAt(screenPoint).intersectPlane(plane, new Vector3());
    return at ?? this.centre.clone();
  }

  // Returns the angle of rotation between two screen points, in degrees, the short way round.
  private turnBetween(from: ScreenPoint, to: ScreenPoint): number {
    const axis = this.turnAxis();
    const facing = axis.dot(this.camera.towards(this.centre));
    if (Math.abs(facing) < edgeOn) return this.turnAlongEdge(axis, from, to);
    const a = this.pointInPlane(axis, from).sub(this.centre);
    const b = this.pointInPlane(axis, to).sub(this.centre);
    return (Math.atan2(a.clone().cross(b).dot(axis), a.dot(b)) * 180) / Math.PI;
  }

  // A ring seen edge-on is a line on the screen. A movement along it by the ring's radius counts as one radian.
  private turnAlongEdge(axis: Vector3, from: ScreenPoint, to: ScreenPoint): number {
    const sight = this.camera.towards(this.centre);
    const line = this.onPage(sight.cross(axis).normalize());
    const way = (to.x - from.x) * line.x + (to.y - from.y) * line.y;
    return ((way / this.ringPx) * 180) / Math.PI;
  }
}

/** Usual radius of the gizmo's rings, in pixels. */
export const ringRadiusPx = 66;

function snapTo(value: number, step: number | undefined): number {
  return step === undefined || step <= 0 ? value : Math.round(value / step) * step;
}
