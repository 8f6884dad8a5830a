import { expect, test } from "vitest";
import { GraftStarts } from "../../src/app/graft/graft_starts";
import type { Pair, StartCandidate } from "../../src/app/graft/graft_step";
import type { GraftReport, MeshObject, ShownLoop } from "../../src/app/graft/graft_types";
import { LoopCurve } from "../../src/app/graft/loop_curve";

const count = 12;

/** Returns a regular polygon as a loop; `sense` -1 runs the other way. */
function loopOf(sense: 1 | -1): ShownLoop {
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    positions[3 * i] = Math.cos((2 * Math.PI * i) / count);
    positions[3 * i + 1] = Math.sin((sense * 2 * Math.PI * i) / count);
  }
  const vertices = Uint32Array.from({ length: count }, (_, i) => i);
  const curve = new LoopCurve(vertices, positions);
  return { vertices, length: curve.length, curve };
}

const candidate = (source: number, target: number) => ({ start: [source, target] }) as unknown as StartCandidate;
const found = candidate(0, 0);
const turned = candidate(0, count / 2);

function startsOf(pair: Pair, report: { value: GraftReport | null }) {
  return new GraftStarts({
    source: { value: { mesh: 2 } as MeshObject },
    target: { value: { mesh: 1 } as MeshObject },
    pairs: { value: [pair] },
    step: { value: undefined },
    loops: { value: new Map([[1, [loopOf(-1)]], [2, [loopOf(1)]]]) },
    report,
  });
}

test("a candidate that is chosen keeps its angle, also if no start was found before", () => {
  const pair: Pair = { sourceLoop: 0, targetLoop: 0, start: turned.start, matches: [] };
  const report: { value: GraftReport | null } = { value: { pairs: [{ starts: [found, turned] }] } as unknown as GraftReport };
  const starts = startsOf(pair, report);
  expect(starts.candidatesOf(0)).toEqual([found, turned]);
  expect(starts.twistOfCandidate(pair, found)).toBeCloseTo(0, 6);
  expect(Math.abs(starts.twistOfCandidate(pair, turned) ?? NaN)).toBeCloseTo(180, 6);
  report.value = { pairs: [{ starts: [] }] } as unknown as GraftReport; // none is told for a given start
  expect(starts.candidatesOf(0)).toEqual([found, turned]);
  expect(Math.abs(starts.twistOf(0))).toBeCloseTo(180, 6);
});

test("without candidates a twist is relative to the given start", () => {
  const pair: Pair = { sourceLoop: 0, targetLoop: 0, start: turned.start, matches: [] };
  const starts = startsOf(pair, { value: null });
  expect(starts.candidatesOf(0)).toEqual([]);
  expect(starts.twistOf(0)).toBeCloseTo(0, 6);
});
