// The placement of a handle, and how gestures change it. No state, no screen.
import { Matrix3, Matrix4, Quaternion, Vector3 } from "three";
import type { Pose } from "../protocol";

/** A rotation by any angle, also beyond a full turn. `axis` has length 1. */
export interface Turn {
  readonly axis: Vector3;
  readonly angleDeg: number;
}

/**
 * x' = c + t + R S (x - c), with c the pivot, t the translation, R the rotation and S the scale along the axes at rest.
 */
export interface Motion {
  readonly kind: "motion";
  readonly translate: Vector3;
  readonly turn: Turn;
  readonly scale: Vector3;
  readonly pivot: Vector3;
}

/** An affine map that is not a `Motion`: sheared, or from a file. Only the page knows its pivot, given at rest. */
export interface Affine {
  readonly kind: "affine";
  readonly matrix: Matrix4;
  readonly pivot: Vector3;
  /** For a redrawn curve: its points. The matrix maps them and the pivot. */
  readonly course?: readonly Vector3[];
}

export type Placement = Motion | Affine;

/** The points x with (x - point) · normal = 0; `normal` has length 1. */
export interface Plane {
  readonly point: Vector3;
  readonly normal: Vector3;
}

const noTurn: Turn = { axis: new Vector3(0, 0, 1), angleDeg: 0 };
const exact = 1e-9; // relative tolerance for rounding, of right angles and equal scales

export function atRest(pivot: Vector3): Motion {
  return { kind: "motion", translate: new Vector3(), turn: noTurn, scale: new Vector3(1, 1, 1), pivot: pivot.clone() };
}

/** Returns the placement of a pose; undefined for a pose from a file, whose matrix must be given instead. */
export function placementOf(pose: Pose, defaultPivot: Vector3): Placement | undefined {
  if (pose.def !== undefined) return undefined;
  if (pose.curve !== undefined) return redrawn(pose.curve.map((point) => new Vector3(...point)));
  if (pose.matrix !== undefined) {
    const [a, b, c, d] = pose.matrix;
    return { kind: "affine", matrix: new Matrix4().set(...a, ...b, ...c, ...d), pivot: defaultPivot.clone() };
  }
  const { translate = [0, 0, 0], rotate, scale = 1, pivot } = pose;
  const axis = rotate === undefined ? noTurn.axis : new Vector3(...rotate.axis).normalize();
  return {
    kind: "motion",
    translate: new Vector3(...translate),
    turn: { axis, angleDeg: rotate?.angle_deg ?? 0 },
    scale: typeof scale === "number" ? new Vector3(scale, scale, scale) : new Vector3(...scale),
    pivot: pivot === undefined ? defaultPivot.clone() : new Vector3(...pivot),
  };
}

function redrawn(course: readonly Vector3[]): Affine {
  const middle = course.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(course.length);
  return { kind: "affine", matrix: new Matrix4(), pivot: middle, course };
}

/** Returns the pose of a placement, without fields that have no effect. */
export function poseOf(placement: Placement, defaultPivot: Vector3): Pose {
  if (placement.kind === "affine") {
    const { course, matrix } = placement;
    const [first, second, ...others] = (course ?? []).map((point) => point.clone().applyMatrix4(matrix).toArray());
    if (first !== undefined && second !== undefined) return { curve: [first, second, ...others] };
    return { matrix: rowsOf(matrix) };
  }
  const { translate, turn, scale, pivot } = placement;
  const pose: Pose = {};
  if (translate.lengthSq() > 0) pose.translate = translate.toArray();
  if (turn.angleDeg !== 0) pose.rotate = { axis: turn.axis.toArray(), angle_deg: turn.angleDeg };
  if (!scale.equals(new Vector3(1, 1, 1))) pose.scale = isUniform(scale) ? scale.x : scale.toArray();
  if (pivot.distanceTo(defaultPivot) > 1e-12 * (1 + defaultPivot.length())) pose.pivot = pivot.toArray();
  return pose;
}

/** Returns whether the placement is a redrawn curve. No map of the handle at rest gives its shape. */
export function isRedrawn(placement: Placement): boolean {
  return placement.kind === "affine" && placement.course !== undefined;
}

export function matrixOf(placement: Placement): Matrix4 {
  if (placement.kind === "affine") return placement.matrix.clone();
  const { translate, turn, scale, pivot } = placement;
  const linear = turnMatrix(turn).scale(scale);
  const at = pivot.clone().add(translate).sub(pivot.clone().applyMatrix4(linear));
  return linear.setPosition(at);
}

/** Returns the current position of the pivot. */
export function centreOf(placement: Placement): Vector3 {
  if (placement.kind === "affine") return placement.pivot.clone().applyMatrix4(placement.matrix);
  return placement.pivot.clone().add(placement.translate);
}

/** Returns the current directions of the handle's own axes, as a rotation whose columns they are. */
export function axesOf(placement: Placement): Quaternion {
  if (placement.kind === "motion") return quaternionOf(placement.turn);
  const x = new Vector3();
  const y = new Vector3();
  const z = new Vector3();
  placement.matrix.extractBasis(x, y, z);
  x.normalize();
  y.addScaledVector(x, -x.dot(y)).normalize();
  z.crossVectors(x, y);
  if (!isFinite(z.lengthSq()) || z.lengthSq() < 0.5) return new Quaternion();
  return new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, y, z));
}

export function moved(placement: Placement, by: Vector3): Placement {
  if (placement.kind === "motion") return { ...placement, translate: placement.translate.clone().add(by) };
  return { ...placement, matrix: new Matrix4().setPosition(by).multiply(placement.matrix) };
}

/** Returns the placement rotated about the current pivot; `turn` is in world coordinates. */
export function turned(placement: Placement, turn: Turn): Placement {
  if (placement.kind === "motion") return { ...placement, turn: composeTurns(placement.turn, turn) };
  return { ...placement, matrix: about(centreOf(placement), turnMatrix(turn)).multiply(placement.matrix) };
}

/** Returns the placement scaled about the current pivot, along world axes given as columns of a rotation. */
export function scaled(placement: Placement, factors: Vector3, axes: Quaternion): Placement {
  const toWorld = new Matrix4().makeRotationFromQuaternion(axes);
  const stretch = toWorld.clone().scale(factors).multiply(toWorld.clone().transpose());
  if (placement.kind === "motion") {
    const own = inOwnAxes(stretch, placement.turn);
    if (own !== undefined) return { ...placement, scale: placement.scale.clone().multiply(own) };
  }
  const matrix = about(centreOf(placement), stretch).multiply(matrixOf(placement));
  return { kind: "affine", matrix, pivot: placement.pivot };
}

/** Returns the same map with the pivot at what is currently shown at `point`. */
export function withPivotAt(placement: Placement, point: Vector3): Placement {
  const pivot = point.clone().applyMatrix4(matrixOf(placement).invert());
  if (placement.kind === "affine") return { ...placement, pivot };
  return { ...placement, pivot, translate: point.clone().sub(pivot) };
}

/** Returns the same map with its pivot at `pivot`, a point at rest. */
export function withPivot(placement: Placement, pivot: Vector3): Placement {
  if (placement.kind === "affine") return { ...placement, pivot: pivot.clone() };
  const translate = pivot.clone().applyMatrix4(matrixOf(placement)).sub(pivot);
  return { ...placement, pivot: pivot.clone(), translate };
}

/**
 * Returns the placement of the twin beyond a mirror: H A H for the reflection H. Rotations keep their number of turns.
 */
export function mirrored(placement: Placement, plane: Plane): Placement {
  const reflection = reflectionIn(plane);
  const pivot = placement.pivot.clone().applyMatrix4(reflection);
  if (placement.kind === "motion") {
    const { translate, turn, scale } = placement;
    const flip = (v: Vector3) => v.clone().addScaledVector(plane.normal, -2 * v.dot(plane.normal));
    const twin: Motion = {
      kind: "motion",
      translate: flip(translate),
      // A reflection reverses the sense of rotation, so the axis is reflected and the angle negated.
      turn: { axis: flip(turn.axis), angleDeg: turn.angleDeg === 0 ? 0 : -turn.angleDeg },
      scale: scale.clone(),
      pivot,
    };
    if (isUniform(scale) || isAlongAxis(plane.normal)) return twin;
  }
  const matrix = reflection.clone().multiply(matrixOf(placement)).multiply(reflection);
  return { kind: "affine", matrix, pivot };
}

/**
 * Composes two rotations into one. About the same axis the angles add up. Otherwise the result is the product of the
 * rotations plus the full turns of the first, so that it changes smoothly as the second grows.
 */
export function composeTurns(first: Turn, then: Turn): Turn {
  if (then.angleDeg === 0) return first;
  if (first.angleDeg === 0) return then;
  const along = first.axis.dot(then.axis);
  if (first.axis.clone().cross(then.axis).length() < 1e-7)
    return { axis: first.axis, angleDeg: first.angleDeg + Math.sign(along) * then.angleDeg };
  const whole = Math.floor(Math.abs(first.angleDeg) / 360);
  const rest = Math.sign(first.angleDeg) * (Math.abs(first.angleDeg) - 360 * whole);
  // The signs of these half-angle quaternions matter: they distinguish a rotation of 350° from one of -10°.
  const product = quaternionOf(then).multiply(quaternionOf({ axis: first.axis, angleDeg: rest }));
  const sine = Math.hypot(product.x, product.y, product.z);
  if (sine < 1e-15) return { axis: first.axis, angleDeg: 360 * whole * Math.sign(first.angleDeg) };
  const axis = new Vector3(product.x, product.y, product.z).divideScalar(sine);
  return { axis, angleDeg: (2 * Math.atan2(sine, product.w) * 180) / Math.PI + 360 * whole };
}

/** Returns the quaternion of a rotation from half of `angleDeg`, including full turns, which decide its sign. */
function quaternionOf({ axis, angleDeg }: Turn): Quaternion {
  const half = (angleDeg * Math.PI) / 360;
  const sine = Math.sin(half);
  return new Quaternion(axis.x * sine, axis.y * sine, axis.z * sine, Math.cos(half));
}

function turnMatrix({ axis, angleDeg }: Turn): Matrix4 {
  return new Matrix4().makeRotationAxis(axis, ((angleDeg % 360) * Math.PI) / 180);
}

function about(centre: Vector3, linear: Matrix4): Matrix4 {
  return linear.clone().setPosition(centre.clone().sub(centre.clone().applyMatrix4(linear)));
}

// Returns the factors s with `stretch` R = R diag(s), where R is the rotation `turn`. Undefined if its columns are not
// the principal directions of `stretch`.
function inOwnAxes(stretch: Matrix4, turn: Turn): Vector3 | undefined {
  const rotation = turnMatrix(turn);
  const own = new Matrix3().setFromMatrix4(rotation.clone().transpose().multiply(stretch).multiply(rotation));
  const e = own.elements;
  const largest = Math.max(...e.map(Math.abs));
  const offDiagonal = [e[1], e[2], e[3], e[5], e[6], e[7]].map(Math.abs);
  return Math.max(...offDiagonal) <= exact * largest ? new Vector3(e[0], e[4], e[8]) : undefined;
}

function reflectionIn({ point, normal }: Plane): Matrix4 {
  const { x, y, z } = normal;
  const linear = new Matrix4().set(
    1 - 2 * x * x, -2 * x * y, -2 * x * z, 0,
    -2 * x * y, 1 - 2 * y * y, -2 * y * z, 0,
    -2 * x * z, -2 * y * z, 1 - 2 * z * z, 0,
    0, 0, 0, 1,
  );
  return linear.setPosition(normal.clone().multiplyScalar(2 * point.dot(normal)));
}

function isUniform({ x, y, z }: Vector3): boolean {
  const tolerance = exact * Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
  return Math.abs(x - y) <= tolerance && Math.abs(x - z) <= tolerance;
}

function isAlongAxis({ x, y, z }: Vector3): boolean {
  return Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) > 1 - exact;
}

type Row = [number, number, number, number];

function rowsOf({ elements: e }: Matrix4): [Row, Row, Row, Row] {
  const row = (i: 0 | 1 | 2): Row => [e[i], e[i + 4] ?? 0, e[i + 8] ?? 0, e[i + 12] ?? 0];
  return [row(0), row(1), row(2), [0, 0, 0, 1]];
}
