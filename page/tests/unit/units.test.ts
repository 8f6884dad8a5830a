import { describe, expect, test } from "vitest";
import {
  counted, formatBytes, formatCount, formatNumber, formatPercent, formatSeconds, formatSize, formatSizeInMm,
  parseQuantity, unitsOfFiles,
} from "../../src/app/units";

describe("numbers that people read", () => {
  test.each([
    [0, "0"], [1, "1"], [-2.5, "-2.5"], [0.123456, "0.1235"], [1234.56, "1235"], [123456, "123456"], [0.00012, "0.00012"],
    [5e-5, "0.00005"], [1e-9, "1e-9"], [2.5e12, "2.5e12"], [100, "100"], [Infinity, "–"],
  ])("%d is %s", (value, text) => expect(formatNumber(value)).toBe(text));

  test("what is shown is what is read back, to the digits shown", () => {
    for (let exponent = -8; exponent <= 9; ++exponent)
      for (const mantissa of [1, -1.5, 3.14159, 9.9999]) {
        const value = mantissa * 10 ** exponent;
        const back = parseQuantity(formatNumber(value, 6), "number");
        expect(Math.abs((back ?? NaN) - value)).toBeLessThanOrEqual(1e-5 * Math.abs(value));
      }
  });

  test("units, counts, times and sizes", () => {
    expect(formatSize([1, 2, 0.5], "in")).toBe("1 × 2 × 0.5 in");
    expect(formatSizeInMm([1, 2, 0.5], "in")).toBe("25.4 × 50.8 × 12.7 mm");
    for (const unit of ["mm", "none"] as const) expect(formatSizeInMm([1, 2, 0.5], unit)).toBe("");
    expect(formatSize([1, 2, 0.5], "none")).toBe("1 × 2 × 0.5");
    expect(formatCount(1234567)).toBe("1\u202f234\u202f567");
    expect(counted(1, "vertex", "vertices")).toBe("1 vertex");
    expect(counted(2, "vertex", "vertices")).toBe("2 vertices");
    expect(formatSeconds(0.0382)).toBe("38.2 ms");
    expect(formatSeconds(1.26)).toBe("1.3 s");
    expect(formatSeconds(75)).toBe("1 min 15 s");
    expect(formatBytes(999)).toBe("999 B");
    expect(formatBytes(1_323_855)).toBe("1.32 MB");
    expect(formatPercent(0.0213)).toBe("2.1 %");
    expect(formatPercent(0.0001)).toBe("< 0.1 %");
  });
});

describe("numbers that people type", () => {
  test.each([
    ["12", 12], ["  -3.5 ", -3.5], ["1,5", 1.5], [".5", 0.5], ["1e-3", 0.001], ["2*3+4", 10], ["2*(3+4)", 14], ["7/2", 3.5],
    ["10-2-3", 5], ["1 000", 1000], ["1\u202f234\u202f567 + 1", 1234568], ["--2", 2], ["−4", -4],
  ])("%s", (text, value) => expect(parseQuantity(text, "number")).toBeCloseTo(value, 12));

  test.each([
    ["1 in", "mm", 25.4], ["1 cm + 2 mm", "mm", 12], ["5", "cm", 5], ["5 mm", "cm", 0.5], ["2 m", "in", 78.74015748], ["1\"", "mm", 25.4],
  ] as const)("%s in %s", (text, unit, value) => expect(parseQuantity(text, "length", unit)).toBeCloseTo(value, 8));

  test("angles and factors", () => {
    expect(parseQuantity("2 turns", "angle")).toBe(720);
    expect(parseQuantity("720+90", "angle")).toBe(810);
    expect(parseQuantity("3.14159265358979 rad", "angle")).toBeCloseTo(180, 9);
    expect(parseQuantity("45°", "angle")).toBe(45);
    expect(parseQuantity("150 %", "factor")).toBeCloseTo(1.5);
  });

  test.each([
    ["", "number"], ["abc", "number"], ["1 2", "number"], ["(1", "number"], ["1/0", "number"], ["2 kg", "length"], ["5 mm", "angle"],
    ["1+", "number"], ["50 %", "length"],
  ] as const)("%s is no %s", (text, quantity) => expect(parseQuantity(text, quantity, "mm")).toBeUndefined());

  test("every unit of a file takes lengths in other units", () => {
    const inch = (named: keyof typeof unitsOfFiles) => parseQuantity("1 in", "length", unitsOfFiles[named]);
    expect(inch("micron")).toBeCloseTo(25400, 8);
    expect(inch("millimeter")).toBeCloseTo(25.4, 12);
    expect(inch("centimeter")).toBeCloseTo(2.54, 12);
    expect(inch("inch")).toBe(1);
    expect(inch("foot")).toBeCloseTo(1 / 12, 12);
    expect(inch("meter")).toBeCloseTo(0.0254, 12);
    expect(inch("")).toBeUndefined();
  });

  test("a model without a unit takes none", () => {
    expect(parseQuantity("5", "length", "none")).toBe(5);
    expect(parseQuantity("5 mm", "length", "none")).toBeUndefined();
  });
});
