import type { GraftReport, ShownLoop, MeshObject } from "./graft_types";
import { meetingOf, type Meeting, type Pair } from "./graft_step";
import { twistDeg, twisted, type LoopCurve } from "./loop_curve";

/** What is read of a graft. */
interface PairedLoops {
  readonly source: { readonly value: MeshObject | undefined };
  readonly target: { readonly value: MeshObject | undefined };
  readonly pairs: { readonly value: readonly Pair[] };
  readonly loops: { readonly value: ReadonlyMap<number, readonly ShownLoop[]> };
  readonly report: { readonly value: GraftReport | null };
}

/** Where the pairs of a graft begin to meet, as given or as found, and how far they are twisted against that. */
export class GraftStarts {
  private readonly found = new Map<string, Meeting>(); // automatically, last

  constructor(private readonly graft: PairedLoops) {}

  /** The loops of a pair, of source and target; undefined while they are not known. */
  curvesOf(pair: Pair): { source: LoopCurve; target: LoopCurve } | undefined {
    const loop = (thing: MeshObject | undefined, index: number) =>
      this.graft.loops.value.get(thing?.mesh ?? -1)?.[index]?.curve;
    const source = loop(this.graft.source.value, pair.sourceLoop);
    const target = loop(this.graft.target.value, pair.targetLoop);
    return source === undefined || target === undefined ? undefined : { source, target };
  }

  /** Where a pair starts: as given, or as it was found last. */
  of(index: number, pairs = this.graft.pairs.value): Meeting | undefined {
    const pair = pairs[index];
    if (pair === undefined) return undefined;
    const reported = this.graft.report.value?.pairs?.[index]?.start;
    return meetingOf(pair.start) ?? this.found.get(this.keyOf(pair)) ?? meetingOf(reported);
  }

  /** By how much a pair is turned against what was found, in degrees along the loop. */
  twistOf(index: number, pairs = this.graft.pairs.value): number {
    const pair = pairs[index];
    const curves = pair && this.curvesOf(pair);
    const start = this.of(index, pairs);
    const base = pair && this.untwisted(pair);
    if (curves === undefined || start === undefined || base === undefined) return 0;
    return twistDeg(curves.source, curves.target, base, start);
  }
  /** All pairs, with one twisted by an angle. */
  withTwist(index: number, angleDeg: number): readonly Pair[] | undefined {
    const pair = this.graft.pairs.value[index];
    const curves = pair && this.curvesOf(pair);
    const base = pair && this.untwisted(pair);
    if (curves === undefined || base === undefined) return undefined;
    const [a, b] = twisted(curves.source, curves.target, base, angleDeg);
    return this.graft.pairs.value.map((other, i) => (i === index ? { ...other, start: [a, b] } : other));
  }

  /** Keeps the starts that were found. */
  learn(report: GraftReport): void {
    this.graft.pairs.value.forEach((pair, i) => {
      const start = meetingOf(report.pairs?.[i]?.start);
      if (start !== undefined && pair.start === undefined && pair.matches.length === 0)
        this.found.set(this.keyOf(pair), start);
    });
  }

  /** What a twist counts from: the start that was found; the given one where none was. */
  private untwisted(pair: Pair): Meeting | undefined {
    const key = this.keyOf(pair);
    const kept = this.found.get(key) ?? meetingOf(pair.start);
    if (kept !== undefined) this.found.set(key, kept);
    return kept;
  }

  private keyOf({ sourceLoop, targetLoop }: Pair): string {
    return [this.graft.source.value?.mesh, sourceLoop, this.graft.target.value?.mesh, targetLoop].join(" ");
  }
}
