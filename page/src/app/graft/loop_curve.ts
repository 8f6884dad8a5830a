// Boundary loops as curves parametrised by arc length. No state, no screen.
import { Line3, Vector3 } from "three";
import type { MatchedVertices, Vector3Tuple } from "./graft_step";

/** A closed loop of vertices with arc-length parameters: 0 at the first vertex, below 1 at all others. */
export class LoopCurve {
  readonly length: number;
  private readonly parameters: Float64Array;
  private readonly indexOfVertex = new Map<number, number>();
  private opposite: LoopCurve | undefined;

  constructor(
    readonly vertices: Uint32Array,
    private readonly positions: Float32Array,
  ) {
    const n = vertices.length;
    this.parameters = new Float64Array(n);
    let length = 0;
    for (let i = 0; i < n; ++i) {
      this.parameters[i] = length;
      this.indexOfVertex.set(vertices[i] as number, i);
      length += distance(positions, vertices[i] as number, vertices[(i + 1) % n] as number);
    }
    this.length = length;
    if (length > 0) for (let i = 0; i < n; ++i) this.parameters[i] = (this.parameters[i] as number) / length;
  }

  /** Returns the same loop in the opposite order: that of the mirror image of its surface. */
  reversed(): LoopCurve {
    return (this.opposite ??= new LoopCurve(this.vertices.slice().reverse(), this.positions));
  }

  has(vertex: number): boolean {
    return this.indexOfVertex.has(vertex);
  }

  /** Returns the parameter of a vertex; undefined if it is not on this loop. */
  parameterOf(vertex: number): number | undefined {
    const index = this.indexOfVertex.get(vertex);
    return index === undefined ? undefined : this.parameters[index];
  }

  /** Returns the vertex nearest to a parameter of the loop. */
  vertexAt(parameter: number): number {
    let best = 0;
    const distanceTo = (i: number) => Math.abs(between(this.parameters[i] as number, parameter));
    for (let i = 1; i < this.parameters.length; ++i) if (distanceTo(i) < distanceTo(best)) best = i;
    return this.vertices[best] as number;
  }
}

/** Returns the parameter of the point of a loop that is nearest to a point, and their distance. */
export function placeOn(loop: LoopCurve, positionOf: (vertex: number) => Vector3Tuple, point: Vector3): { parameter: number; distance: number } {
  const { vertices } = loop;
  const at = (i: number) => new Vector3(...positionOf(vertices[i % vertices.length] as number));
  let best = { parameter: 0, distance: Infinity };
  for (let i = 0; i < vertices.length; ++i) {
    const edge = new Line3(at(i), at(i + 1));
    const share = edge.closestPointToPointParameter(point, true);
    const distance = edge.at(share, new Vector3()).distanceTo(point);
    if (distance >= best.distance) continue;
    const begin = loop.parameterOf(vertices[i] as number) ?? 0;
    const end = i + 1 < vertices.length ? (loop.parameterOf(vertices[i + 1] as number) ?? 0) : 1;
    best = { parameter: begin + share * (end - begin), distance };
  }
  return best;
}

/** Returns the signed distance from `from` to `to` along a loop, as a share of its length: -0.5 to 0.5. */
export function between(from: number, to: number): number {
  return to - from - Math.round(to - from);
}

/**
 * Returns the parameter on the target loop that matches a vertex of the source loop, given one match. The loops run
 * opposite parameters.
 */
export function matchingParameter(
  source: LoopCurve,
  target: LoopCurve,
  start: MatchedVertices,
  vertex: number,
): number | undefined {
  const from = source.parameterOf(start[0]);
  const at = source.parameterOf(vertex);
  const to = target.parameterOf(start[1]);
  return from === undefined || at === undefined || to === undefined ? undefined : to - (at - from);
}

/** Returns the twist of `start` relative to `base`, in degrees along the target loop: -180 to 180. */
export function twistDeg(source: LoopCurve, target: LoopCurve, base: MatchedVertices, start: MatchedVertices): number {
  const untwisted = matchingParameter(source, target, base, start[0]);
  const now = target.parameterOf(start[1]);
  return untwisted === undefined || now === undefined ? 0 : 360 * between(untwisted, now);
}

/**
 * Returns the start that is twisted by `angleDeg` relative to `base`. Tries all vertices of both loops and takes the
 * closest pair, so that coarse loops turn finely, too.
 */
export function twisted(source: LoopCurve, target: LoopCurve, base: MatchedVertices, angleDeg: number): MatchedVertices {
  let best = base;
  let least = Infinity;
  const many = Math.max(1, Math.floor(source.vertices.length / 256));
  for (let i = 0; i < source.vertices.length; i += many) {
    const vertex = source.vertices[i] as number;
    const parameter = matchingParameter(source, target, base, vertex);
    if (parameter === undefined) return base;
    const wanted = parameter + angleDeg / 360;
    const found = target.vertexAt(wanted - Math.floor(wanted));
    const off = Math.abs(between(target.parameterOf(found) ?? 0, wanted)) + 1e-9 * Math.abs(between(source.parameterOf(base[0]) ?? 0, source.parameterOf(vertex) ?? 0));
    if (off < least) {
      least = off;
      best = [vertex, found];
    }
  }
  return best;
}

/**
 * Returns whether the matches are in the same order along both loops, which run opposite ways. Crossing matches are
 * refused.
 */
export function areInOrder(source: LoopCurve, target: LoopCurve, matches: readonly MatchedVertices[]): boolean {
  const first = matches[0];
  if (first === undefined) return true;
  const from = (parameter: number | undefined, origin: number | undefined) => {
    const difference = (parameter ?? 0) - (origin ?? 0);
    return difference - Math.floor(difference);
  };
  const parameters = matches.map(([s, t]): [number, number] => [
    from(source.parameterOf(s), source.parameterOf(first[0])),
    from(target.parameterOf(first[1]), target.parameterOf(t)),
  ]);
  parameters.sort((a, b) => a[0] - b[0]);
  return parameters.every(([s, t], i) => {
    const before = parameters[i - 1];
    return before === undefined || (s > before[0] && t > before[1]);
  });
}

/** Returns the vertex of a polyline on the page that is nearest to a point, and its distance in pixels. */
export function nearestPoint(points: ArrayLike<number>, x: number, y: number): { index: number; distance: number } {
  let index = -1;
  let least = Infinity;
  for (let i = 0; 2 * i + 1 < points.length; ++i) {
    const far = ((points[2 * i] as number) - x) ** 2 + ((points[2 * i + 1] as number) - y) ** 2;
    if (far < least) {
      least = far;
      index = i;
    }
  }
  return { index, distance: Math.sqrt(least) };
}

function distance(p: Float32Array, a: number, b: number): number {
  return Math.hypot(...[0, 1, 2].map((k) => (p[3 * a + k] ?? 0) - (p[3 * b + k] ?? 0)));
}
