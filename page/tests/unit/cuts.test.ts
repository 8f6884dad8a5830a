import { describe, expect, test } from "vitest";
import { closingFields, closingOf, isHalf, keptFields, otherSide } from "../../src/app/cuts";

describe("how a cut is closed", () => {
  test("is read from the fields of its step as it was written", () => {
    for (const closing of [{ cap: "open" }, { cap: "flat" }, { cap: "pins", pins: { count: 3 } }] as const)
      expect(closingOf(closingFields(closing))).toEqual(closing);
    expect(closingFields({ cap: "pins" })).toEqual({ pins: {} });
  });
});

test("both sides are kept as two objects, and one side has another", () => {
  expect(keptFields("both")).toEqual({ halves: true });
  expect(otherSide({ do: "cut", ...keptFields("above") })).toEqual({ do: "cut", keep: "below" });
  expect(otherSide({ do: "cut", ...keptFields("both") })).toBeUndefined();
});

test("the two cuts that divide an object are halves, and other cuts are none", () => {
  const plane = { point: [0, 0, 0.5], normal: [0, 0, 1] };
  const cut = (fields: object) => ({ kind: "cut" as const, fields: { mesh: "bar", plane, ...fields } });
  const halves = [cut({ keep: "below", result: "bar 2" }), cut({ keep: "above" }), { kind: "deform" as const, fields: {} }];
  expect(halves.map((_, i) => isHalf(halves, i))).toEqual([true, true, false]);
  const others = [cut({ keep: "below" }), cut({ keep: "above", cap: "flat" }), cut({ keep: "below" })];
  expect(others.map((_, i) => isHalf(others, i))).toEqual([false, false, false]);
});
