// The mirror image of a graft, as the fields of a new graft. No state, no screen.
import { Matrix4, Vector3 } from "three";
import type { EditSelection, Match, Vector } from "../../protocol";
import type { Plane } from "../mirror_plane";
import { isMirrored, type GraftFields, type MatchedVertices, type Rows4, type Vector3Tuple } from "./graft_step";
import { between, placeOn, twisted, type LoopCurve } from "./loop_curve";

/** The graft to be mirrored, and the model that it gave. */
export interface GraftToMirror {
  /** The fields of its step. */
  readonly fields: GraftFields;
  /** The vertices that met at the start of each pair, of the source and of the target. */
  readonly starts: readonly MatchedVertices[];
  /** The places where the starts' vertices of the source met the target's loops, between its vertices; null if unknown. */
  readonly places: readonly (Vector | null)[];
  /** The open loops of the model. */
  readonly loops: readonly LoopCurve[];
  /** The open loops of the part. */
  readonly partLoops: readonly LoopCurve[];
  /** Returns the position of a vertex of the model. The target's vertices keep their numbers in it. */
  positionOf(vertex: number): Vector3Tuple;
}

/** Returns the fields of the mirror image of a graft; undefined if the model has no loop where it would be. */
export function mirroredGraft(graft: GraftToMirror, plane: Plane): GraftFields | undefined {
  const { mirror, source_transform, at, pairs, target: _, ...same } = graft.fields;
  const reflect = reflectionAt(plane);
  const posing = mirroredPosing(reflect, plane, mirror, source_transform);
  if (at != null) {
    const mirrored = mirroredPlace(graft, reflect, at);
    return { ...same, ...posing, at: mirrored };
  }
  const turnsOver = isMirrored({ mirror: posing.mirror ?? undefined, sourceTransform: posing.source_transform ?? undefined });
  const mirroredPairs = (pairs ?? []).map((pair, i) => mirroredPair(graft, reflect, pair, i, turnsOver));
  if (mirroredPairs.length === 0 || mirroredPairs.some((pair) => pair === undefined)) return undefined;
  return { ...same, ...posing, pairs: mirroredPairs.filter((pair) => pair !== undefined) };
}

/** Returns the map that mirrors points at a plane. */
export function reflectionAt({ point, normal }: Plane): Matrix4 {
  const n = new Vector3(...normal).normalize();
  const [x, y, z] = n.toArray();
  const linear = new Matrix4().set(
    1 - 2 * x * x, -2 * x * y, -2 * x * z, 0,
    -2 * x * y, 1 - 2 * y * y, -2 * y * z, 0,
    -2 * x * z, -2 * y * z, 1 - 2 * z * z, 0,
    0, 0, 0, 1,
  );
  const shift = n.clone().multiplyScalar(2 * n.dot(new Vector3(...point)));
  return linear.setPosition(shift);
}

// The part is mirrored first and then transformed. Two mirrors are a transform.
function mirroredPosing(
  reflect: Matrix4,
  plane: Plane,
  mirror: GraftFields["mirror"],
  transform: GraftFields["source_transform"],
): Pick<GraftFields, "mirror" | "source_transform"> {
  const moved = transform == null ? undefined : new Matrix4().set(...(transform.flat() as Parameters<Matrix4["set"]>));
  if (mirror != null) {
    const whole = reflect.clone();
    if (moved !== undefined) whole.multiply(moved);
    return { source_transform: rowsOf(whole.multiply(reflectionAt(mirror))) };
  }
  if (moved === undefined) return { mirror: plane };
  return { mirror: plane, source_transform: rowsOf(reflect.clone().multiply(moved).multiply(reflect)) };
}

function rowsOf(matrix: Matrix4): Rows4 {
  const e = matrix.elements;
  const row = (i: number): Rows4[0] => [e[i] ?? 0, e[i + 4] ?? 0, e[i + 8] ?? 0, e[i + 12] ?? 0];
  return [row(0), row(1), row(2), row(3)];
}

type At = NonNullable<GraftFields["at"]>;

// A turn about an axis becomes the opposite turn about the mirrored axis.
function mirroredPlace({ positionOf }: GraftToMirror, reflect: Matrix4, at: At): At {
  const { point, vertex, spin_deg, base, ...same } = at as At & { vertex?: number; point?: Vector };
  const place = new Vector3(...(point ?? positionOf(vertex ?? 0))).applyMatrix4(reflect);
  return {
    ...same,
    point: place.toArray(),
    ...(spin_deg !== undefined && { spin_deg: -spin_deg }),
    ...(base !== undefined && { base: mirroredBase(reflect, base) }),
  } as At;
}

function mirroredBase<Base extends object>(reflect: Matrix4, base: Base): Base {
  const { tilt_deg, tilt_axis } = base as { tilt_deg?: number; tilt_axis?: Vector };
  if (tilt_deg === undefined || tilt_deg === 0) return base;
  const axis = new Vector3(...(tilt_axis ?? [1, 0, 0])).transformDirection(reflect).negate();
  return { ...base, tilt_axis: axis.toArray() };
}

type RequestPair = NonNullable<GraftFields["pairs"]>[number];

function mirroredPair(graft: GraftToMirror, reflect: Matrix4, pair: RequestPair, index: number, turnsOver: boolean): RequestPair | undefined {
  const start = graft.starts[index];
  if (start === undefined) return undefined;
  const across = (point: Vector) => new Vector3(...point).applyMatrix4(reflect);
  const met = across(graft.places[index] ?? graft.positionOf(start[1]));
  const loop = loopNear(graft, met);
  const curve = graft.loops[loop ?? -1];
  if (curve === undefined) return undefined;
  const mirrored = (target: Match[1]) => nearestVertex(graft, curve, across(typeof target === "number" ? graft.positionOf(target) : target));
  const nearest: MatchedVertices = [start[0], nearestVertex(graft, curve, met)];
  const matches = pair.matches ?? [];
  const [source, target] = matches.length === 0 ? nearestStart(graft, curve, met, nearest, turnsOver) : nearest;
  return {
    source_loop: pair.source_loop,
    target_loop: { loop } as EditSelection,
    start: [source, target],
    ...(pair.matches !== undefined && { matches: matches.map(([source, target]): Match => [source, mirrored(target)]) }),
  };
}

// Returns the start that turns the part as if the start's vertex of the part met the loop at a point between its vertices.
function nearestStart(graft: GraftToMirror, curve: LoopCurve, met: Vector3, start: MatchedVertices, turnsOver: boolean): MatchedVertices {
  const own = graft.partLoops.find((loop) => loop.has(start[0]));
  if (own === undefined) return start;
  const { parameter } = placeOn(curve, graft.positionOf, met);
  const angle = 360 * between(curve.parameterOf(start[1]) ?? 0, parameter);
  return twisted(turnsOver ? own.reversed() : own, curve, start, angle);
}

/** Returns the loop that passes a point, within a tenth of the loop's length. */
function loopNear({ loops, positionOf }: GraftToMirror, point: Vector3): number | undefined {
  let best: number | undefined;
  let least = Infinity;
  loops.forEach((curve, loop) => {
    const { distance } = placeOn(curve, positionOf, point);
    if (distance >= least || distance > 0.1 * curve.length) return;
    best = loop;
    least = distance;
  });
  return best;
}

function nearestVertex({ positionOf }: GraftToMirror, curve: LoopCurve, point: Vector3): number {
  return curve.vertexAt(placeOn(curve, positionOf, point).parameter);
}
