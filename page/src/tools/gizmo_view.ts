import { Quaternion, Vector3 } from "three";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import { ringRadiusPx, type GestureKind, type Gesture } from "./gesture";
import { circle, layOut, shifted, viewRingPx, type Layout, type Part } from "./gizmo_layout";
import { linesThrough, onOverlay, set, show, svg } from "./svg";

/** The current appearance of the gizmo. */
export interface Appearance {
  readonly centre: Vector3;
  readonly axes: Quaternion;
  /** Its size, × the usual one. */
  readonly scale: number;
  /** How far it is drawn from its centre, in pixels. */
  readonly shift: ScreenPoint;
  /** The part under the pointer. */
  readonly hovered: string | undefined;
  /** The gesture in progress, and where it began. */
  readonly gesture: { readonly gesture: Gesture; readonly from: Vector3; readonly axes: Quaternion } | undefined;
  readonly movesPivot: boolean;
  /** The available kinds of gesture; absent: all. */
  readonly gestureKinds: readonly GestureKind[] | undefined;
  isHidden(part: Part): boolean;
}

/** Draws the gizmo on the overlay. Lines have a halo, so that they are legible on light and dark surfaces. */
export class GizmoView {
  readonly element = svg("g", { class: "gizmo", display: "none" });
  private readonly leader = svg("path", { class: "leader" });
  private readonly leaderEnd = svg("circle", { class: "leader-end", r: 3.5 });
  private readonly link = svg("g", { class: "gizmo", display: "none" }, this.leader, this.leaderEnd);
  private readonly guide = svg("path", { class: "guide" });
  private readonly sector = svg("path", { class: "sector" });
  private readonly cross = svg("path", { d: "M-13 0H13M0 -13V13" });
  private readonly pivot = svg("g", { class: "pivot" }, svg("circle", { r: 7 }), this.cross);
  private readonly parts = new Map<string, SVGGElement>();

  constructor(
    private readonly overlay: SVGSVGElement,
    private readonly camera: ScreenCamera,
  ) {
    this.element.append(this.guide, this.sector, this.pivot);
    overlay.append(this.link, this.element);
  }

  hide(): void {
    show(this.link, false);
    show(this.element, false);
  }

  /** Draws the gizmo and returns where its parts are on the screen. */
  draw(look: Appearance): Layout | undefined {
    const whole = layOut(look.centre, look.axes, this.camera, look.scale);
    const layout = { ...whole, parts: whole.parts.filter(({ grip }) => look.gestureKinds?.includes(grip.kind) !== false) };
    const isInSight = !this.camera.project(look.centre).behind;
    show(this.element, isInSight);
    if (!isInSight) show(this.link, false);
    if (!isInSight) return undefined;
    set(this.element, { transform: `translate(${look.shift.x} ${look.shift.y})` });
    this.drawLink(layout.centre, look.shift);
    const active = look.gesture === undefined ? undefined : partOf(look.gesture.gesture);
    const shown = new Set<string>();
    for (const part of layout.parts) {
      if (look.movesPivot || (active !== undefined && part.id !== active)) continue;
      shown.add(part.id);
      this.drawPart(part, layout, part.id === (active ?? look.hovered), look.isHidden(part));
    }
    for (const [id, element] of this.parts) show(element, shown.has(id));
    this.drawPivot(layout, look.movesPivot);
    this.drawGuides(look);
    return shifted(layout, look.shift);
  }

  // Draws the line from a gizmo beside its centre to the centre.
  private drawLink(centre: ScreenPoint, shift: ScreenPoint): void {
    const [c] = onOverlay(this.overlay, [centre]) as [ScreenPoint];
    show(this.link, Math.hypot(shift.x, shift.y) > 1);
    set(this.leader, { d: linesThrough([c, { x: c.x + shift.x, y: c.y + shift.y }]) });
    set(this.leaderEnd, { cx: c.x, cy: c.y });
  }

  private drawPart(part: Part, layout: Layout, isHovered: boolean, isHidden: boolean): void {
    const element = this.elementOf(part);
    const axis = part.axis === "free" ? "free" : "xyz".charAt(part.axis);
    set(element, { class: `part ${part.kind} axis-${axis}${isHovered ? " hot" : ""}${isHidden ? " covered" : ""}` });
    const outline = onOverlay(this.overlay, part.outline);
    const [c] = onOverlay(this.overlay, [layout.centre]) as [ScreenPoint];
    const d = part.kind === "view-ring" ? circlePath(c, layout.scale * viewRingPx) : shapeOf(part, outline, c);
    for (const path of element.children) set(path, { d });
  }

  private elementOf(part: Part): SVGGElement {
    const known = this.parts.get(part.id);
    if (known !== undefined) return known;
    const made = svg("g", { "data-part": part.id }, svg("path", { class: "halo" }), svg("path", { class: "line" }));
    this.parts.set(part.id, made);
    this.element.append(made);
    return made;
  }

  private drawPivot(layout: Layout, isShown: boolean): void {
    const [c] = onOverlay(this.overlay, [layout.centre]) as [ScreenPoint];
    show(this.pivot, isShown);
    set(this.pivot, { transform: `translate(${c.x} ${c.y})` });
  }

  // Draws the line or ring of a gesture, and the angle of a rotation.
  private drawGuides({ gesture, centre, scale }: Appearance): void {
    show(this.guide, gesture !== undefined);
    show(this.sector, gesture?.gesture.currentGrip.kind === "turn");
    if (gesture === undefined) return;
    const { kind, axis } = gesture.gesture.currentGrip;
    const name = axis === "free" ? "free" : "xyz".charAt(axis);
    set(this.guide, { class: `guide axis-${name}` });
    if (kind === "turn") this.drawSector(gesture.gesture, centre, name, scale);
    else if (axis === "free" && kind === "scale")
      set(this.guide, { d: linesThrough([...this.screenPoints(centre), ...onOverlay(this.overlay, [gesture.gesture.pointer])]) });
    else if (axis === "free") set(this.guide, { d: linesThrough(this.screenPoints(gesture.from, centre)) });
    else {
      const along = new Vector3().setComponent(axis, 1).applyQuaternion(gesture.axes);
      along.multiplyScalar(2000 * this.camera.worldPerPixel(centre));
      const ends = this.screenPoints(gesture.from.clone().sub(along), gesture.from.clone().add(along));
      set(this.guide, { d: linesThrough(ends) });
    }
  }

  private drawSector(gesture: Gesture, centre: Vector3, name: string, scale: number): void {
    const pixel = this.camera.worldPerPixel(centre);
    const radius = scale * (gesture.currentGrip.axis === "free" ? viewRingPx : ringRadiusPx);
    const at = (...steps: [Vector3, number][]) =>
      this.camera.project(steps.reduce((sum, [v, px]) => sum.addScaledVector(v, px * pixel), centre.clone()));
    const axis = gesture.turnAxis();
    const ring = circle(at, axis, this.camera.towards(centre), radius, 2 * Math.PI);
    set(this.guide, { d: linesThrough(onOverlay(this.overlay, ring), true) });
    const first = gesture.startDirection();
    const side = axis.clone().cross(first);
    const angle = (Math.sign(gesture.angleDeg()) * Math.min(360, Math.abs(gesture.angleDeg())) * Math.PI) / 180;
    const screenPoints = [at()];
    for (let i = 0; i <= 48; ++i) {
      const turned = (angle * i) / 48;
      screenPoints.push(at([first, radius * Math.cos(turned)], [side, radius * Math.sin(turned)]));
    }
    set(this.sector, { class: `sector axis-${name}`, d: linesThrough(onOverlay(this.overlay, screenPoints), true) });
  }

  private screenPoints(...points: Vector3[]): ScreenPoint[] {
    return onOverlay(this.overlay, points.map((point) => this.camera.project(point)));
  }
}

/** Returns the part that belongs to a gesture, also for free rotations and scalings by keys. */
function partOf(gesture: Gesture): string {
  const { kind, axis, across } = gesture.currentGrip;
  const kinds = { move: across === true ? "square" : "arrow", turn: "ring", scale: "box" } as const;
  const free = { move: "ball", turn: "view-ring", scale: "knob" } as const;
  return axis === "free" ? free[kind] : `${kinds[kind]}-${"xyz".charAt(axis)}`;
}

function shapeOf(part: Part, outline: readonly ScreenPoint[], centre: ScreenPoint): string {
  const [first, second] = outline;
  if (first === undefined) return "";
  switch (part.kind) {
    case "ball":
      return circlePath(first, 7);
    case "knob":
      return cornerPath(first) + squarePath({ x: first.x + 2, y: first.y - 2 }, 7);
    case "box":
      return squarePath(first, 5);
    case "arrow":
      return second === undefined ? "" : linesThrough(outline) + headPath(centre, second);
    default:
      return linesThrough(outline, part.closed);
  }
}

function circlePath({ x, y }: ScreenPoint, r: number): string {
  return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
}

function squarePath({ x, y }: ScreenPoint, half: number): string {
  return `M${x - half} ${y - half}h${2 * half}v${2 * half}h${-2 * half}Z`;
}

function cornerPath({ x, y }: ScreenPoint): string {
  return `M${x - 7} ${y + 7}v-9M${x - 7} ${y + 7}h9`;
}

// Returns the path of an arrow head: a triangle on the screen at `tip`, pointing away from `from`.
function headPath(from: ScreenPoint, tip: ScreenPoint): string {
  const size = Math.hypot(tip.x - from.x, tip.y - from.y) || 1;
  const [x, y] = [(tip.x - from.x) / size, (tip.y - from.y) / size];
  const base = { x: tip.x - 11 * x, y: tip.y - 11 * y };
  return linesThrough([{ x: base.x - 5 * y, y: base.y + 5 * x }, tip, { x: base.x + 5 * y, y: base.y - 5 * x }], true);
}
