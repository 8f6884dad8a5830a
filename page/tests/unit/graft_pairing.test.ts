import { signal } from "@preact/signals";
import { beforeEach, expect, test } from "vitest";
import { Graft, type GraftReport } from "../../src/app/graft/graft";
import { graftWords, needsPair } from "../../src/app/graft/graft_words";
import type { DocumentState, PageRequest } from "../../src/protocol";

type Step = { source: string; target: string; pairs: object[] } | null;

const documentWith = (step: Step, loops = 4) =>
  ({
    model: { name: "body", mesh: 1, loops },
    parts: [{ name: "arms", mesh: 2, loops, grafted: false }],
    graft: step === null ? null : { step, graft: 1 },
  }) as unknown as DocumentState;

let asked: PageRequest[] = [];
let trial: Partial<GraftReport> = {};
let state = signal<DocumentState | null>(null);
let graft: Graft;

beforeEach(() => {
  asked = [];
  trial = {};
  state = signal<DocumentState | null>(documentWith(null));
  const answer = (request: PageRequest) => {
    asked.push(request);
    return Promise.resolve({ graft: asked.length });
  };
  graft = new Graft({
    state,
    ask: answer,
    attempt: answer,
    request: async (request) => {
      const done = await answer(request);
      graft.onEvent({ event: "graft", graft: done.graft, dragged: true, ...trial } as GraftReport);
      return done;
    },
    note: () => undefined,
    positionsOf: () => undefined,
  });
});

const pair = () => graft.pair({ mesh: 1, loop: 2 }, { mesh: 2, loop: 3 });
const loops = { source_loop: { loop: 3 }, target_loop: { loop: 2 } };

test("a double click accepts once", async () => {
  await Promise.all([graft.accept(), graft.accept()]);
  expect(asked).toEqual([{ do: "accept" }]);
  await graft.accept();
  expect(asked.length).toBe(2);
});

test("the result is shown as soon as there is one", async () => {
  graft.arrangement.value = "apart";
  await pair();
  expect(graft.arrangement.value).toBe("both");
  const error = { id: "merge.component_without_pair", fields: { component: 0, vertices: 9, vertex: 0 } };
  graft.onEvent({ event: "graft", graft: 1, error } as unknown as GraftReport);
  expect(graft.arrangement.value).toBe("both");
  graft.onEvent({ event: "graft", graft: 2, seam: {} } as unknown as GraftReport);
  expect(graft.arrangement.value).toBe("result");
  graft.arrangement.value = "apart"; // to pair another loop
  graft.onEvent({ event: "graft", graft: 3, seam: {} } as unknown as GraftReport);
  expect(graft.arrangement.value).toBe("apart");
});

test("pairs that are clicked at once come one after another", async () => {
  await Promise.all([pair(), graft.pair({ mesh: 1, loop: 0 }, { mesh: 2, loop: 1 })]);
  expect(asked.map((request) => request.do)).toEqual(["graft", "graft"]);
});

test("loops are paired without a start, and the rotations that the engine tells can be chosen", async () => {
  await pair();
  expect(asked[0]).toMatchObject({ do: "graft", pairs: [loops] });
  state.value = documentWith({ source: "arms", target: "body", pairs: [loops] });
  const starts = [
    { start: [1, 2], probability: 0.6, turn_deg: 0 },
    { start: [3, 4], probability: 0.3, turn_deg: 90 },
  ];
  const report = { event: "graft", graft: 1, pairs: [{ start: [1, 2], confidence: 0.6, starts }] };
  graft.onEvent(report as unknown as GraftReport);
  expect(graft.starts.candidatesOf(0)).toEqual(starts);
  state.value = documentWith({ source: "arms", target: "body", pairs: [{ ...loops, start: [3, 4] }] });
  graft.onEvent({ ...report, graft: 2, pairs: [{ start: [3, 4], confidence: 1, starts: [] }] } as unknown as GraftReport);
  expect(graft.starts.candidatesOf(0)).toEqual(starts); // they stay to be chosen from
  state.value = documentWith({ source: "arms", target: "body", pairs: [loops, loops] });
  graft.onEvent({ ...report, graft: 3, pairs: [{ start: [5, 6], confidence: 1, starts: [] }] } as unknown as GraftReport);
  expect(graft.starts.candidatesOf(0)).toEqual([]); // another pair determines the start
});

test("a part with pieces that are not paired yet says how many pairs are to go, and no error", () => {
  state.value = documentWith({ source: "arms", target: "body", pairs: [loops] });
  const error = { id: "merge.component_without_pair", fields: { component: 0, vertices: 9, vertex: 0 } };
  graft.report.value = { event: "graft", graft: 1, error } as unknown as GraftReport;
  expect(needsPair(graft)).toBe(true);
  expect(graftWords(graft)).toMatchObject({ tone: "idle", text: "1 more pair needed, up to 3 possible" });
  graft.report.value = { event: "graft", graft: 1, error: { id: "merge.no_pairs", fields: {} } } as unknown as GraftReport;
  expect(needsPair(graft)).toBe(false);
  expect(graftWords(graft).tone).toBe("problem");
});
