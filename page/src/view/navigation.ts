import {
  Box3,
  MathUtils,
  Matrix4,
  OrthographicCamera,
  PerspectiveCamera,
  Quaternion,
  Vector3,
  type Sphere,
} from "three";
import { uprightOf, vectorOf, type Upright } from "../app/upright";

const fieldOfViewDeg = 32;

/** A viewpoint: a target, a distance, and two angles of a turntable. */
interface Viewpoint {
  target: Vector3;
  distance: number;
  yaw: number;
  pitch: number;
}

/** The functions of the view that navigation uses. */
export interface NavigatedView {
  requestRender(): void;
  /** Returns the point of the scene under a point of the page, as the centre of turning and zooming. */
  pointUnder(clientX: number, clientY: number): Vector3 | undefined;
  bounds(): Sphere;
  fitUnder(clientX: number, clientY: number): void;
}

/**
 * Controls the turntable camera by mouse, wheel, trackpad and fingers. Its listeners on the canvas's host run after
 * those of tools. A left drag belongs to a tool that prevented the event's default.
 */
export class Navigation {
  /** Returns whether the camera must stay where it is: a tool is dragging. */
  isBlocked: () => boolean = () => false;
  isMoving = false;
  readonly perspective = new PerspectiveCamera(fieldOfViewDeg, 1, 0.01, 1000);
  readonly parallel = new OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
  orthographic = false;
  upright: Upright = uprightOf("z");
  private viewpoint: Viewpoint = {
    target: new Vector3(),
    distance: 5,
    yaw: MathUtils.degToRad(-35),
    pitch: MathUtils.degToRad(20),
  };
  private transition: { from: Viewpoint; to: Viewpoint; start: number; ms: number } | undefined;
  /** What the last `fit` framed, as long as no other movement followed. */
  private framed: { positions: Float32Array; margin: number } | undefined;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private drag: "orbit" | "pan" | undefined;
  private host: HTMLElement | undefined;
  private wheelZoom: { point: Vector3; until: number } | undefined;
  private restTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly view: NavigatedView) {}

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.orthographic ? this.parallel : this.perspective;
  }
  /** Whether a drag or a pinch moves the camera. */
  get isDragging(): boolean {
    return this.drag !== undefined;
  }
  get target(): Vector3 {
    return this.viewpoint.target;
  }
  get distance(): number {
    return this.viewpoint.distance;
  }
  /** Height of the visible region at the target, in world units. */
  get viewHeight(): number {
    return 2 * this.viewpoint.distance * Math.tan(MathUtils.degToRad(fieldOfViewDeg / 2));
  }

  attach(host: HTMLElement): void {
    this.host = host;
    host.style.touchAction = "none";
    host.addEventListener("pointerdown", (event) => this.press(event));
    host.addEventListener("pointermove", (event) => this.move(event));
    host.addEventListener("pointerup", (event) => this.release(event));
    host.addEventListener("pointercancel", (event) => this.release(event));
    host.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    host.addEventListener("contextmenu", (event) => event.preventDefault());
    host.addEventListener("dblclick", (event) => {
      if (!event.defaultPrevented && this.isOnCanvas(event)) this.view.fitUnder(event.clientX, event.clientY);
    });
  }

  /** Updates the cameras before each picture. What was framed stays framed if the picture's proportions change. */
  update(aspect: number): void {
    const { framed } = this;
    if (framed !== undefined && aspect !== this.perspective.aspect) {
      this.perspective.aspect = aspect;
      this.fit(framed.positions, framed.margin, false);
    }
    if (this.transition !== undefined) this.animate(performance.now());
    const { viewpoint } = this;
    const position = this.directionToCamera(viewpoint).multiplyScalar(viewpoint.distance).add(viewpoint.target);
    const turn = this.orientation(viewpoint);
    const bounds = this.view.bounds();
    const toCentre = position.distanceTo(bounds.center);
    const far = 1.02 * (toCentre + 4 * bounds.radius);
    for (const camera of [this.perspective, this.parallel]) {
      camera.position.copy(position);
      camera.quaternion.copy(turn);
    }
    this.perspective.aspect = aspect;
    this.perspective.near = Math.max(
      far * 1e-5,
      Math.min(viewpoint.distance * 0.05, 0.5 * Math.max(0, toCentre - bounds.radius)) || viewpoint.distance * 0.01,
    );
    this.perspective.far = far;
    const half = this.viewHeight / 2;
    Object.assign(this.parallel, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    this.parallel.near = -far;
    this.parallel.far = far;
    this.perspective.updateProjectionMatrix();
    this.parallel.updateProjectionMatrix();
    this.perspective.updateMatrixWorld();
    this.parallel.updateMatrixWorld();
  }

  /**
   * Frames world points (3 numbers each) with a margin around them, without turning the camera. The movement is
   * animated.
   */
  fit(positions: Float32Array, margin: number, animated = true): void {
    const goal = this.goal();
    const turn = this.orientation(goal);
    const back = turn.clone().invert();
    const box = new Box3();
    const seen = new Vector3();
    for (let i = 0; i < positions.length; i += 3) box.expandByPoint(seen.fromArray(positions, i).applyQuaternion(back));
    if (box.isEmpty()) return;
    const middle = box.getCenter(new Vector3());
    const slope = Math.tan(MathUtils.degToRad(fieldOfViewDeg / 2)) * 0.78; // leaves a margin for what is above the view
    const aspect = this.perspective.aspect;
    let distance = 0;
    for (let i = 0; i < positions.length; i += 3) {
      seen.fromArray(positions, i).applyQuaternion(back).sub(middle);
      const half = Math.max((Math.abs(seen.x) + margin) / aspect, Math.abs(seen.y) + margin);
      distance = Math.max(distance, half / slope + (this.orthographic ? 0 : seen.z + margin));
    }
    this.moveTo({ ...goal, target: middle.applyQuaternion(turn), distance: Math.max(distance, 1e-30) }, animated);
    this.framed = { positions, margin };
  }

  /** Looks along a world direction. `up` fixes the orientation if the direction is vertical. */
  lookAlong(direction: Vector3, up?: Vector3, animated = true): void {
    const [front, right, above] = this.axes();
    const toCamera = direction.clone().normalize().negate();
    const pitch = Math.asin(MathUtils.clamp(toCamera.dot(above), -1, 1));
    const goal = this.goal();
    let yaw = goal.yaw;
    if (Math.abs(pitch) < MathUtils.degToRad(89.9)) yaw = Math.atan2(toCamera.dot(right), toCamera.dot(front));
    else if (up !== undefined) {
      const sign = pitch > 0 ? -1 : 1;
      yaw = Math.atan2(sign * up.dot(right), sign * up.dot(front));
    } else yaw = (Math.round(yaw / (Math.PI / 2)) * Math.PI) / 2;
    yaw += 2 * Math.PI * Math.round((goal.yaw - yaw) / (2 * Math.PI));
    this.moveTo({ ...goal, yaw, pitch }, animated);
  }

  /** Turns by angles, as a drag does. */
  orbit(yaw: number, pitch: number): void {
    this.transition = this.framed = undefined;
    this.viewpoint.yaw += yaw;
    this.viewpoint.pitch = MathUtils.clamp(this.viewpoint.pitch + pitch, -Math.PI / 2, Math.PI / 2);
    this.noteMovement();
  }

  /** Moves the scene by pixels of the page. */
  pan(dx: number, dy: number): void {
    this.transition = this.framed = undefined;
    const perPixel = this.viewHeight / Math.max(1, this.host?.clientHeight ?? 1);
    const turn = this.orientation(this.viewpoint);
    const shift = new Vector3(-dx * perPixel, dy * perPixel, 0).applyQuaternion(turn);
    this.viewpoint.target.add(shift);
    this.noteMovement();
  }

  /** Zooms towards a point (factor < 1: nearer), which stays where it is on the screen. */
  zoom(factor: number, point: Vector3): void {
    this.transition = this.framed = undefined;
    const { viewpoint } = this;
    const size = this.view.bounds().radius;
    const next = MathUtils.clamp(viewpoint.distance * factor, size * 1e-4, size * 60);
    viewpoint.target.lerp(point, 1 - next / viewpoint.distance);
    viewpoint.distance = next;
    this.noteMovement();
  }

  /** The turntable's axes in the world: towards a viewer at the front, to the right, and up. */
  axes(): [Vector3, Vector3, Vector3] {
    const front = new Vector3(...vectorOf(this.upright.front));
    const above = new Vector3(...vectorOf(this.upright.up));
    return [front, above.clone().cross(front), above];
  }

  orientation(viewpoint: { yaw: number; pitch: number } = this.viewpoint): Quaternion {
    const [front, right, above] = this.axes();
    const level = front.clone().multiplyScalar(Math.cos(viewpoint.yaw)).addScaledVector(right, Math.sin(viewpoint.yaw));
    const x = right.clone().multiplyScalar(Math.cos(viewpoint.yaw)).addScaledVector(front, -Math.sin(viewpoint.yaw));
    const y = above.clone().multiplyScalar(Math.cos(viewpoint.pitch)).addScaledVector(level, -Math.sin(viewpoint.pitch));
    return new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, y, this.directionToCamera(viewpoint)));
  }

  /** Returns the unit direction to the right on the screen, for the viewpoint that the camera is moving to. */
  rightward(): Vector3 {
    return new Vector3(1, 0, 0).applyQuaternion(this.orientation(this.goal()));
  }

  private directionToCamera(viewpoint: { yaw: number; pitch: number }): Vector3 {
    const [front, right, above] = this.axes();
    const level = front.multiplyScalar(Math.cos(viewpoint.yaw)).addScaledVector(right, Math.sin(viewpoint.yaw));
    return level.multiplyScalar(Math.cos(viewpoint.pitch)).addScaledVector(above, Math.sin(viewpoint.pitch));
  }

  private goal(): Viewpoint {
    const { target, ...rest } = this.transition?.to ?? this.viewpoint;
    return { ...rest, target: target.clone() };
  }

  private moveTo(to: Viewpoint, animated: boolean): void {
    this.framed = undefined;
    const still = globalThis.matchMedia?.("(prefers-reduced-motion: reduce)").matches ?? false;
    const { target, ...rest } = this.viewpoint;
    this.transition = {
      from: { ...rest, target: target.clone() },
      to,
      start: performance.now(),
      ms: animated && !still ? 220 : 0,
    };
    if (this.transition.ms === 0) this.animate(performance.now());
    this.view.requestRender();
  }

  private animate(now: number): void {
    if (this.transition === undefined) return;
    const { from, to, start, ms } = this.transition;
    const t = ms === 0 ? 1 : MathUtils.clamp((now - start) / ms, 0, 1);
    const s = t * t * (3 - 2 * t);
    this.viewpoint.target.lerpVectors(from.target, to.target, s);
    this.viewpoint.distance = from.distance * (to.distance / from.distance) ** s;
    this.viewpoint.yaw = MathUtils.lerp(from.yaw, to.yaw, s);
    this.viewpoint.pitch = MathUtils.lerp(from.pitch, to.pitch, s);
    if (t === 1) this.transition = undefined;
    if (ms > 0) this.noteMovement();
  }

  /** Notes a movement. A moment after the last one the view counts as being at rest. */
  private noteMovement(): void {
    this.isMoving = true;
    clearTimeout(this.restTimer);
    this.restTimer = setTimeout(() => this.noteRest(), 180);
    this.view.requestRender();
  }
  private noteRest(): void {
    if (this.drag !== undefined) {
      this.restTimer = setTimeout(() => this.noteRest(), 180);
      return;
    }
    this.isMoving = false;
    this.view.requestRender();
  }

  private isOnCanvas(event: Event): boolean {
    return event.target instanceof HTMLCanvasElement;
  }

  private press(event: PointerEvent): void {
    if (this.isBlocked() || !this.isOnCanvas(event)) return;
    if (event.defaultPrevented && event.button === 0 && event.pointerType === "mouse") return;
    if (event.pointerType === "touch") this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (event.defaultPrevented && this.pointers.size < 2) return;
    const pans = event.button === 2 || (event.button === 1 && event.shiftKey) || (event.button === 0 && event.shiftKey);
    this.drag = pans ? "pan" : "orbit";
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    (event.target as Element).setPointerCapture(event.pointerId); // the canvas itself, so that it gets its clicks
    if (event.button === 1) event.preventDefault();
  }

  private move(event: PointerEvent): void {
    const last = this.pointers.get(event.pointerId);
    if (last === undefined || this.drag === undefined) return;
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    if (this.pointers.size === 2) this.pinch(event, last);
    else if (this.drag === "pan") this.pan(dx, dy);
    else this.orbit(-dx * 0.0075, dy * 0.0075);
    last.x = event.clientX;
    last.y = event.clientY;
  }

  /** Handles two fingers: their midpoint pans, their distance zooms. */
  private pinch(event: PointerEvent, last: { x: number; y: number }): void {
    const other = [...this.pointers.values()].find((pointer) => pointer !== last);
    if (other === undefined) return;
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
    this.pan((event.clientX - last.x) / 2, (event.clientY - last.y) / 2);
    if (before > 10 && after > 10)
      this.zoom(before / after, this.onTargetPlane((event.clientX + other.x) / 2, (event.clientY + other.y) / 2));
  }

  private release(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.pointers.size === 0) this.drag = undefined;
  }

  private wheel(event: WheelEvent): void {
    if (!this.isOnCanvas(event)) return;
    event.preventDefault();
    if (this.isBlocked()) return;
    if (event.shiftKey || (!event.ctrlKey && event.deltaMode === 0 && event.deltaX !== 0)) {
      this.pan(-(event.deltaX || event.deltaY), event.shiftKey ? 0 : -event.deltaY);
      return;
    }
    const unit = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
    const now = performance.now();
    if (this.wheelZoom === undefined || now > this.wheelZoom.until)
      this.wheelZoom = {
        point:
          this.view.pointUnder(event.clientX, event.clientY) ?? this.onTargetPlane(event.clientX, event.clientY),
        until: 0,
      };
    this.wheelZoom.until = now + 250;
    const delta = MathUtils.clamp(unit * event.deltaY, -300, 300);
    this.zoom(Math.exp(delta * (event.ctrlKey ? 0.01 : 0.0016)), this.wheelZoom.point);
  }

  /**
   * Returns the world point under a point of the page, in the plane through the target that is parallel to the screen.
   */
  private onTargetPlane(clientX: number, clientY: number): Vector3 {
    const box = this.host?.getBoundingClientRect();
    if (box === undefined) return this.viewpoint.target.clone();
    const x = (clientX - box.left - box.width / 2) * (this.viewHeight / box.height);
    const y = (box.top + box.height / 2 - clientY) * (this.viewHeight / box.height);
    return new Vector3(x, y, 0).applyQuaternion(this.orientation()).add(this.viewpoint.target);
  }
}
