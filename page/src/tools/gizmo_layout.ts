// Computes where the parts of the gizmo are on the screen, and which one is under the pointer. No state, no document.
import { Quaternion, Vector3 } from "three";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import { ringRadiusPx, type Axis, type Grip } from "./gesture";

export type PartKind = "arrow" | "square" | "ring" | "box" | "ball" | "knob" | "view-ring";

/** A part that can be dragged. `outline` is drawn, and picked within a tolerance. */
export interface Part {
  readonly id: string;
  readonly kind: PartKind;
  readonly grip: Grip;
  readonly axis: Axis | "free";
  readonly outline: readonly ScreenPoint[];
  readonly closed: boolean;
  /** The point that is tested for being hidden by the model, in world coordinates. */
  readonly position: Vector3;
}

export interface Layout {
  readonly centre: ScreenPoint;
  readonly parts: readonly Part[];
  /** Its size, × the usual one. */
  readonly scale: number;
}

const allAxes: readonly Axis[] = [0, 1, 2];
const arrowPx = { from: 15, to: 92 };
const squarePx = { from: 24, to: 42 };
const boxPx = 112;
export const viewRingPx = 136;
const endOn = 0.97; // cosine above which an arrow points at the camera and is not drawn
const edgeOn = 0.15; // cosine below which a square is seen edge-on and is not drawn
const circlePoints = 64; // points of a circle

/** Lays out the gizmo at `centre` along the columns of `axes`, `scale` times as large on the screen as usual. */
export function layOut(centre: Vector3, axes: Quaternion, camera: ScreenCamera, scale = 1): Layout {
  const pixel = scale * camera.worldPerPixel(centre);
  const viewDirection = camera.towards(centre);
  const along = allAxes.map((k) => new Vector3(+(k === 0), +(k === 1), +(k === 2)).applyQuaternion(axes));
  const of = (k: Axis): Vector3 => along[k] as Vector3;
  const pointAt = (...steps: [Vector3, number][]) =>
    steps.reduce((at, [axis, px]) => at.addScaledVector(axis, px * pixel), centre.clone());
  const screenPointAt = (...steps: [Vector3, number][]): ScreenPoint => camera.project(pointAt(...steps));
  const c = camera.project(centre);
  const parts: Part[] = [];
  const add = (part: Omit<Part, "id">) =>
    parts.push({ ...part, id: part.axis === "free" ? part.kind : `${part.kind}-${"xyz".charAt(part.axis)}` });

  const ball: Grip = { kind: "move", axis: "free" };
  add({ kind: "ball", grip: ball, axis: "free", outline: [c], closed: false, position: centre });
  const knobPx = scale * viewRingPx * Math.SQRT1_2;
  const knob = { x: c.x + knobPx, y: c.y - knobPx };
  const all: Grip = { kind: "scale", axis: "free" };
  add({ kind: "knob", grip: all, axis: "free", outline: [knob], closed: false, position: centre });
  for (const k of allAxes) {
    if (Math.abs(of(k).dot(viewDirection)) > endOn) continue;
    const end = pointAt([of(k), boxPx]);
    const stretch: Grip = { kind: "scale", axis: k };
    add({ kind: "box", grip: stretch, axis: k, outline: [camera.project(end)], closed: false, position: end });
    const shaft = [screenPointAt([of(k), arrowPx.from]), screenPointAt([of(k), arrowPx.to])];
    add({ kind: "arrow", grip: { kind: "move", axis: k }, axis: k, outline: shaft, closed: false,
          position: pointAt([of(k), arrowPx.to]) });
  }
  for (const k of allAxes) {
    if (Math.abs(of(k).dot(viewDirection)) < edgeOn) continue;
    const u = of(((k + 1) % 3) as Axis);
    const v = of(((k + 2) % 3) as Axis);
    const { from, to } = squarePx;
    const corners = [[from, from], [to, from], [to, to], [from, to]] as const;
    const outline = corners.map(([a, b]) => screenPointAt([u, a], [v, b]));
    add({ kind: "square", grip: { kind: "move", axis: k, across: true }, axis: k, outline, closed: true,
          position: pointAt([u, to], [v, to]) });
  }
  for (const k of allAxes) {
    const outline = circle(screenPointAt, of(k), viewDirection, ringRadiusPx, Math.PI);
    add({ kind: "ring", grip: { kind: "turn", axis: k }, axis: k, outline, closed: false, position: centre });
  }
  const round = Array.from({ length: circlePoints }, (_, i): ScreenPoint => {
    const angle = (2 * Math.PI * i) / circlePoints;
    return { x: c.x + scale * viewRingPx * Math.cos(angle), y: c.y + scale * viewRingPx * Math.sin(angle) };
  });
  const roll: Grip = { kind: "turn", axis: "free" };
  add({ kind: "view-ring", grip: roll, axis: "free", outline: round, closed: true, position: centre });
  return { centre: c, parts, scale };
}

/** Returns a layout that is drawn beside its centre. */
export function shifted(layout: Layout, by: ScreenPoint): Layout {
  const move = ({ x, y }: ScreenPoint) => ({ x: x + by.x, y: y + by.y });
  return {
    ...layout,
    centre: move(layout.centre),
    parts: layout.parts.map((part) => ({ ...part, outline: part.outline.map(move) })),
  };
}

/** Returns a ring around `axis`: the half that faces the camera if `span` is π, the whole ring if it is 2π. */
export function circle(
  screenPointAt: (...steps: [Vector3, number][]) => ScreenPoint,
  axis: Vector3,
  viewDirection: Vector3,
  radiusPx: number,
  span: number,
): ScreenPoint[] {
  const side = viewDirection.clone().cross(axis);
  const aside = Math.abs(axis.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  if (side.lengthSq() < 1e-6) side.crossVectors(axis, aside);
  side.normalize();
  const near = side.clone().cross(axis);
  if (near.dot(viewDirection) > 0) near.negate();
  const facesCamera = Math.abs(axis.dot(viewDirection)) > 0.98; // all of the ring is visible
  const half = facesCamera ? Math.PI : span / 2;
  const points = Math.round((circlePoints * half) / Math.PI);
  return Array.from({ length: points + 1 }, (_, i) => {
    const angle = -half + (2 * half * i) / points;
    return screenPointAt([near, radiusPx * Math.cos(angle)], [side, radiusPx * Math.sin(angle)]);
  });
}

// A press takes the first of these kinds within its tolerance in pixels.
const order: readonly [PartKind, number][] = [
  ["ball", 9],
  ["knob", 12],
  ["box", 10],
  ["arrow", 8],
  ["square", 3],
  ["ring", 7],
  ["view-ring", 7],
];

const arrowBesideSquare = 0.25; // × its tolerance: an arrow gives way to a square that the pointer is in

/** Returns the part under the pointer. `toleranceFactor` widens the tolerance, for touch. */
export function partAt(layout: Layout, screenPoint: ScreenPoint, toleranceFactor = 1): Part | undefined {
  const isInSquare = layout.parts.some(({ kind, outline }) => kind === "square" && isInside(outline, screenPoint));
  for (const [kind, usualTolerance] of order) {
    const tolerance = kind === "arrow" && isInSquare ? arrowBesideSquare * usualTolerance : usualTolerance;
    const near = layout.parts
      .filter((part) => part.kind === kind)
      .map((part) => ({ part, distance: distanceTo(part, screenPoint) }))
      .sort((a, b) => a.distance - b.distance)[0];
    if (near !== undefined && near.distance <= tolerance * toleranceFactor) return near.part;
  }
  return undefined;
}

/** Names a grip and its effect, for those who do not see it. */
export function gripWords({ kind, axis }: Pick<Part, "kind" | "axis">): string {
  const name = axis === "free" ? "" : "XYZ".charAt(axis);
  const words: Record<PartKind, string> = {
    arrow: `Arrow: moves along ${name}.`,
    square: `Square: moves across ${name}.`,
    ring: `Ring: rotates about ${name}.`,
    box: `Box: scales along ${name}.`,
    ball: "Ball: moves.",
    knob: "Knob: scales.",
    "view-ring": "Outer ring: rotates about the line of sight.",
  };
  return words[kind];
}

function distanceTo({ outline, closed, kind }: Part, screenPoint: ScreenPoint): number {
  if (kind === "square" && isInside(outline, screenPoint)) return 0;
  const last = outline[outline.length - 1];
  if (last === undefined) return Infinity;
  let least = Math.hypot(last.x - screenPoint.x, last.y - screenPoint.y);
  outline.forEach((a, i) => {
    const b = outline[i + 1] ?? (closed ? outline[0] : undefined);
    if (b !== undefined) least = Math.min(least, distanceToSegment(screenPoint, a, b));
  });
  return least;
}

export function distanceToSegment(p: ScreenPoint, a: ScreenPoint, b: ScreenPoint): number {
  const dx = b.x - a.x;
  const dy = b.y - a.y;
  const length = dx * dx + dy * dy;
  const t = length === 0 ? 0 : Math.min(1, Math.max(0, ((p.x - a.x) * dx + (p.y - a.y) * dy) / length));
  return Math.hypot(a.x + t * dx - p.x, a.y + t * dy - p.y);
}

function isInside(polygon: readonly ScreenPoint[], { x, y }: ScreenPoint): boolean {
  let inside = false;
  polygon.forEach((a, i) => {
    const b = polygon[(i + 1) % polygon.length] as ScreenPoint;
    if (a.y > y !== b.y > y && x < a.x + ((y - a.y) / (b.y - a.y)) * (b.x - a.x)) inside = !inside;
  });
  return inside;
}
