// A merge step of the document in the form the page works with, and the fields that change it. No state, no screen.
import { Matrix4 } from "three";
import type { EngineEvent, Match, PageRequest, EditSelection } from "../../protocol";

/** Fields of a graft to be changed by the engine; null removes a field. */
export type GraftFields = Omit<Extract<PageRequest, { do: "graft-drag" }>, "do">;
type RequestPair = NonNullable<GraftFields["pairs"]>[number];

/** A start that the user may have meant, and how probable it is. */
export type StartCandidate = GraftedPair["starts"][number];
type GraftedPair = NonNullable<Extract<EngineEvent, { event: "graft" }>["pairs"]>[number];

/** A vertex of the source and the vertex of the target that it matches. */
export type MatchedVertices = readonly [number, number];

/** Two loops to be joined. Loop numbers are those of the engine's list; -1 if the loop is named in another way. */
export interface Pair {
  readonly sourceLoop: number;
  readonly targetLoop: number;
  readonly start?: Match | undefined; // absent: found automatically
  readonly matches: readonly Match[];
  /** The document's selections of the loops. */
  readonly source?: EditSelection;
  readonly target?: EditSelection;
}

export type Vector3Tuple = [number, number, number];
export type Rows4 = [Row4, Row4, Row4, Row4];
type Row4 = [number, number, number, number];

export interface GraftStep {
  readonly source: string;
  readonly target: string;
  readonly pose: "find" | "keep";
  readonly shape: "similar" | "ft05";
  readonly pairs: readonly Pair[];
  /** The point where the part is dropped, instead of pairs. */
  readonly at: NonNullable<GraftFields["at"]> | undefined;
  readonly size: number | undefined; // absent: found, or the part's own
  readonly normalAngleDeg: number;
  readonly mirror: { point: Vector3Tuple; normal: Vector3Tuple } | undefined;
  readonly sourceTransform: Rows4 | undefined;
  readonly hasFixed: boolean;
  readonly fixed: EditSelection | undefined;
  readonly smoothBoundary: boolean;
  readonly fixWinding: boolean;
  /** Whether other settings are tried where the seam has faults. */
  readonly retry: boolean;
  /** Of the solve and the seam, in the form of the edit file. */
  readonly settings: object;
  /** The length from the seam within which vertex colours mix. */
  readonly blendColours: number;
}

/** Reads `state.graft.step`, which has the form of a merge step in docs/edit-file.md. */
export function readStep(step: object): GraftStep {
  const { source, target, pose, shape, pairs, at, size, mirror, ...rest } = step as GraftFields;
  return {
    source: source ?? "",
    target: target ?? "",
    pose: pose ?? "find",
    shape: shape ?? "similar",
    pairs: (pairs ?? []).map(readPair),
    at: at ?? undefined,
    size: size ?? undefined,
    normalAngleDeg: rest.normal_angle_deg ?? 0,
    mirror: mirror ?? undefined,
    sourceTransform: rest.source_transform ?? undefined,
    hasFixed: (rest.fixed ?? null) !== null,
    fixed: rest.fixed === true || rest.fixed === null ? undefined : rest.fixed,
    smoothBoundary: rest.smooth_boundary ?? false,
    fixWinding: rest.fix_winding ?? false,
    retry: rest.retry ?? true,
    settings: rest.settings ?? {},
    blendColours: (rest.settings as { blend_colours?: number } | null | undefined)?.blend_colours ?? 0,
  };
}

// The engine stores a start as the first of the matches.
function readPair(pair: RequestPair): Pair {
  const [start, ...matches] = [...(pair.start === undefined ? [] : [pair.start]), ...(pair.matches ?? [])];
  return {
    sourceLoop: loopNumber(pair.source_loop),
    targetLoop: loopNumber(pair.target_loop),
    start,
    matches,
    source: pair.source_loop,
    target: pair.target_loop,
  };
}

/** Returns whether a graft turns its part into a mirror image. */
export function isMirrored(step: Pick<GraftStep, "mirror" | "sourceTransform"> | undefined): boolean {
  const rows = step?.sourceTransform;
  const reflects = rows !== undefined && new Matrix4().set(...(rows.flat() as Parameters<Matrix4["set"]>)).determinant() < 0;
  return (step?.mirror !== undefined) !== reflects;
}

function loopNumber(selection: EditSelection): number {
  if (typeof selection !== "object" || selection === null || !("loop" in selection)) return -1;
  return typeof selection.loop === "number" ? selection.loop : -1;
}

/** Returns the request field for these pairs. */
export function pairsField(pairs: readonly Pair[]): RequestPair[] {
  return pairs.map(({ sourceLoop, targetLoop, start, matches, source, target }) => ({
    source_loop: source ?? { loop: sourceLoop },
    target_loop: target ?? { loop: targetLoop },
    ...(start === undefined ? {} : { start }),
    ...(matches.length === 0 ? {} : { matches: [...matches] }),
  }));
}

/** Returns the vertices of a match; undefined if it has points instead. */
export function verticesOfMatch(match: Match | undefined): MatchedVertices | undefined {
  const [source, target] = match ?? [];
  return typeof source === "number" && typeof target === "number" ? [source, target] : undefined;
}

/** Returns the pairs with one more. A loop is in one pair only, so pairs that used one of the two loops are removed. */
export function withPair(pairs: readonly Pair[], sourceLoop: number, targetLoop: number): Pair[] {
  const others = pairs.filter((pair) => pair.sourceLoop !== sourceLoop && pair.targetLoop !== targetLoop);
  return [...others, { sourceLoop, targetLoop, matches: [] }];
}

export function withoutPair(pairs: readonly Pair[], index: number): Pair[] {
  return pairs.filter((_, i) => i !== index);
}

/** A match of a pair by number: the start (0) or a further match (from 1 on). */
export interface MatchRef {
  readonly pair: number;
  readonly match: number;
}

/** Returns the matches of a pair: its start, given or found, then its other matches. */
export function matchesOf(pair: Pair, found: MatchedVertices | undefined): (MatchedVertices | undefined)[] {
  return [verticesOfMatch(pair.start) ?? found, ...pair.matches.map(verticesOfMatch)];
}

/** Returns the pairs with one match moved. A found start becomes a given one. */
export function withMovedMatch(
  pairs: readonly Pair[],
  { pair: index, match }: MatchRef,
  vertices: MatchedVertices,
): Pair[] {
  return pairs.map((pair, i) => {
    if (i !== index) return pair;
    const moved: Match = [vertices[0], vertices[1]];
    if (match === 0) return { ...pair, start: moved };
    return { ...pair, matches: pair.matches.map((old, k) => (k === match - 1 ? moved : old)) };
  });
}

/** Returns the pairs with one more match. A found start becomes a given one, so that it stays. */
export function withMatch(
  pairs: readonly Pair[],
  index: number,
  vertices: MatchedVertices,
  found: MatchedVertices | undefined,
): Pair[] {
  return pairs.map((pair, i) => {
    if (i !== index) return pair;
    const start: Match | undefined = pair.start ?? (found === undefined ? undefined : [found[0], found[1]]);
    return { ...pair, start, matches: [...pair.matches, [vertices[0], vertices[1]] as Match] };
  });
}

/** Returns the pairs without one match. A removed start is found again by the engine. */
export function withoutMatch(pairs: readonly Pair[], { pair: index, match }: MatchRef): Pair[] {
  return pairs.map((pair, i) => {
    if (i !== index) return pair;
    if (match === 0) return { ...pair, start: undefined };
    return { ...pair, matches: pair.matches.filter((_, k) => k !== match - 1) };
  });
}

/** Returns the step with dragged fields on top. */
export function withFields(step: GraftStep, fields: GraftFields): GraftStep {
  const asked = readStep({ source: step.source, target: step.target, ...fields });
  const has = (name: keyof GraftFields) => name in fields;
  return {
    ...step,
    ...(has("pose") && { pose: asked.pose }),
    ...(has("shape") && { shape: asked.shape }),
    ...(has("pairs") && { pairs: asked.pairs }),
    ...(has("at") && { at: asked.at }),
    ...(has("size") && { size: asked.size }),
    ...(has("normal_angle_deg") && { normalAngleDeg: asked.normalAngleDeg }),
    ...(has("mirror") && { mirror: asked.mirror }),
    ...(has("source_transform") && { sourceTransform: asked.sourceTransform }),
    ...(has("fixed") && { hasFixed: asked.hasFixed }),
  };
}
