import type { GraftReport, ShownLoop, MeshObject } from "./graft_types";
import { isMirrored, verticesOfMatch, type GraftStep, type MatchedVertices, type Pair, type StartCandidate } from "./graft_step";
import { twistDeg, twisted, type LoopCurve } from "./loop_curve";

/** The signals of a graft that `GraftStarts` reads. */
interface PairedLoops {
  readonly source: { readonly value: MeshObject | undefined };
  readonly target: { readonly value: MeshObject | undefined };
  readonly pairs: { readonly value: readonly Pair[] };
  readonly step: { readonly value: GraftStep | undefined };
  readonly loops: { readonly value: ReadonlyMap<number, readonly ShownLoop[]> };
  readonly report: { readonly value: GraftReport | null };
}

/** Holds the starts of a graft's pairs, given or found, and computes their twist relative to the found start. */
export class GraftStarts {
  private readonly found = new Map<string, MatchedVertices>(); // last starts found automatically
  private readonly candidates = new Map<string, readonly StartCandidate[]>(); // the most probable first

  constructor(private readonly graft: PairedLoops) {}

  /** Returns the source and target loop of a pair, which run opposite ways; undefined until both are known. */
  curvesOf(pair: Pair): { source: LoopCurve; target: LoopCurve } | undefined {
    const loop = (object: MeshObject | undefined, index: number) =>
      this.graft.loops.value.get(object?.mesh ?? -1)?.[index]?.curve;
    const source = loop(this.graft.source.value, pair.sourceLoop);
    const target = loop(this.graft.target.value, pair.targetLoop);
    if (source === undefined || target === undefined) return undefined;
    return { source: isMirrored(this.graft.step.value) ? source.reversed() : source, target };
  }

  /** Returns the start of a pair: the given one, or else the one found last. */
  of(index: number, pairs = this.graft.pairs.value): MatchedVertices | undefined {
    const pair = pairs[index];
    if (pair === undefined) return undefined;
    const reported = this.graft.report.value?.pairs?.[index]?.start;
    return verticesOfMatch(pair.start) ?? this.found.get(this.keyOf(pair)) ?? verticesOfMatch(reported);
  }

  /**
   * Returns the starts that the user may have meant, the most probable first, as the engine told them last. It tells none
   * for a start that is given, so they are kept to be chosen from.
   */
  candidatesOf(index: number): readonly StartCandidate[] {
    const pair = this.graft.pairs.value[index];
    if (pair === undefined) return [];
    const key = this.keyOfCandidates(pair);
    const told = this.graft.report.value?.pairs?.[index]?.starts;
    const isFound = pair.start === undefined && pair.matches.length === 0;
    if (told !== undefined && (told.length > 0 || isFound)) this.candidates.set(key, told);
    return this.candidates.get(key) ?? [];
  }

  /** Returns the twist of a pair relative to the found start, in degrees along the loop. */
  twistOf(index: number, pairs = this.graft.pairs.value): number {
    const pair = pairs[index];
    const curves = pair && this.curvesOf(pair);
    const start = this.of(index, pairs);
    const base = pair && this.untwisted(pair);
    if (curves === undefined || start === undefined || base === undefined) return 0;
    return twistDeg(curves.source, curves.target, base, start);
  }
  /** Returns the twist that a candidate has; undefined while the loops are not known. */
  twistOfCandidate(pair: Pair, { start }: StartCandidate): number | undefined {
    const curves = this.curvesOf(pair);
    const base = this.untwisted(pair);
    const vertices = verticesOfMatch(start);
    if (curves === undefined || base === undefined || vertices === undefined) return undefined;
    return twistDeg(curves.source, curves.target, base, vertices);
  }
  /** Returns whether a pair has the start of one of its candidates. */
  isCandidate(index: number): boolean {
    const pair = this.graft.pairs.value[index];
    return pair?.start !== undefined && this.candidatesOf(index).some(({ start }) => String(start) === String(pair.start));
  }
  /** Returns all pairs, with one of them twisted by an angle. */
  withTwist(index: number, angleDeg: number): readonly Pair[] | undefined {
    const pair = this.graft.pairs.value[index];
    const curves = pair && this.curvesOf(pair);
    const base = pair && this.untwisted(pair);
    if (curves === undefined || base === undefined) return undefined;
    const [a, b] = twisted(curves.source, curves.target, base, angleDeg);
    return this.graft.pairs.value.map((other, i) => (i === index ? { ...other, start: [a, b] } : other));
  }

  /** Stores the starts that the engine found. */
  storeFound(report: GraftReport): void {
    this.graft.pairs.value.forEach((pair, i) => {
      const start = verticesOfMatch(report.pairs?.[i]?.start);
      if (start !== undefined && pair.start === undefined && pair.matches.length === 0)
        this.found.set(this.keyOf(pair), start);
    });
  }

  /**
   * Returns the start that a twist is relative to: the one found last, else the likeliest candidate, else the given one.
   */
  private untwisted(pair: Pair): MatchedVertices | undefined {
    const key = this.keyOf(pair);
    const likeliest = this.candidates.get(this.keyOfCandidates(pair))?.[0];
    const kept = this.found.get(key) ?? verticesOfMatch(likeliest?.start) ?? verticesOfMatch(pair.start);
    if (kept !== undefined) this.found.set(key, kept);
    return kept;
  }

  private keyOfCandidates(pair: Pair): string {
    const step = this.graft.step.value;
    return [this.keyOf(pair), step?.pose, JSON.stringify(step?.mirror)].join(" ");
  }

  private keyOf({ sourceLoop, targetLoop }: Pair): string {
    return [this.graft.source.value?.mesh, sourceLoop, this.graft.target.value?.mesh, targetLoop].join(" ");
  }
}
