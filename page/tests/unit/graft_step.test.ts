import { expect, test } from "vitest";
import {
  matchesOf, pairsField, readStep, withMovedMatch, withFields, withMatch, withoutMatch, withPair, withoutPair,
} from "../../src/app/graft/graft_step";

const step = {
  kind: "merge", target: "body", source: "arm", normal_angle_deg: 10, shape: "ft05",
  pairs: [{ source_loop: { loop: 1 }, target_loop: { loop: 0 }, start: [5, 77], matches: [[9, 80]] }],
};

test("reads a merge step, with the defaults of the edit file", () => {
  const read = readStep(step);
  expect(read).toMatchObject({ source: "arm", target: "body", pose: "find", shape: "ft05", normalAngleDeg: 10 });
  expect(read.pairs[0]).toMatchObject({ sourceLoop: 1, targetLoop: 0, start: [5, 77], matches: [[9, 80]] });
  expect(readStep({ target: "a", source: "b" })).toMatchObject({ shape: "similar", pairs: [], hasFixed: false });
});

test("reads the settings that the panel shows, and keeps the others", () => {
  expect(readStep(step)).toMatchObject({ retry: true, blendColours: 0, settings: {} });
  const settings = { strip: "greedy", blend_colours: 0.3 };
  expect(readStep({ ...step, retry: false, settings })).toMatchObject({ retry: false, blendColours: 0.3, settings });
});

test("reads a start that is stored as the first of the matches", () => {
  const pairs = [{ source_loop: { loop: 0 }, target_loop: { loop: 0 }, matches: [[0, 7], [3, 4]] }];
  expect(readStep({ source: "a", target: "b", pairs }).pairs[0]).toMatchObject({ start: [0, 7], matches: [[3, 4]] });
});

test("gives pairs back as it read them, also where a loop is named in another way", () => {
  expect(pairsField(readStep(step).pairs)).toEqual(step.pairs);
  const named = [{ source_loop: "rim", target_loop: { produced: { step: "cut", what: "loop" } } }];
  const { pairs } = readStep({ source: "a", target: "b", pairs: named });
  expect(pairs[0]).toMatchObject({ sourceLoop: -1, targetLoop: -1 });
  expect(pairsField(pairs)).toEqual(named);
});

test("keeps a loop in one pair", () => {
  const two = withPair(withPair([], 0, 0), 1, 2);
  expect(two.map(({ sourceLoop, targetLoop }) => [sourceLoop, targetLoop])).toEqual([[0, 0], [1, 2]]);
  expect(withPair(two, 0, 2).map(({ sourceLoop, targetLoop }) => [sourceLoop, targetLoop])).toEqual([[0, 2]]);
  expect(withoutPair(two, 0)).toEqual([two[1]]);
});

test("moves, adds and removes matches", () => {
  const pairs = withPair([], 0, 0);
  const added = withMatch(pairs, 0, [9, 80], [5, 77]);
  expect(added[0]).toMatchObject({ start: [5, 77], matches: [[9, 80]] });
  expect(withMovedMatch(added, { pair: 0, match: 1 }, [9, 81])[0]?.matches).toEqual([[9, 81]]);
  expect(withMovedMatch(pairs, { pair: 0, match: 0 }, [5, 78])[0]?.start).toEqual([5, 78]);
  expect(withoutMatch(added, { pair: 0, match: 1 })[0]?.matches).toEqual([]);
  expect(withoutMatch(added, { pair: 0, match: 0 })[0]?.start).toBeUndefined();
  const [pair] = pairs;
  expect(pair && matchesOf(pair, [1, 2])).toEqual([[1, 2]]);
});

test("shows dragged fields on top of the document's", () => {
  const dragged = withFields(readStep(step), { normal_angle_deg: 25, mirror: { point: [0, 0, 0], normal: [1, 0, 0] } });
  expect(dragged).toMatchObject({ normalAngleDeg: 25, shape: "ft05", mirror: { normal: [1, 0, 0] } });
  expect(dragged.pairs).toHaveLength(1);
  expect(withFields(dragged, { mirror: null }).mirror).toBeUndefined();
});
