import { describe, expect, test } from "vitest";
import { closingFields, closingOf, keptFields, otherSide } from "../../src/app/cuts";

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
