import { expect, test } from "vitest";
import { inflatedHeight, usualReach } from "../../src/app/shaping";

test("a selection is inflated by a part of its size", () => {
  const surface = { selection: Uint8Array.of(255, 0, 255), positions: Float32Array.of(0, 0, 0, 9, 9, 9, 3, 4, 0) };
  expect(inflatedHeight(surface, 1)).toBeCloseTo(1.25);
  expect(inflatedHeight(surface, 0.4)).toBeCloseTo(0.5);
  expect(inflatedHeight({ ...surface, selection: new Uint8Array(3) }, 1)).toBe(0);
  const ofOneVertex = inflatedHeight({ ...surface, selection: Uint8Array.of(0, 255, 0) }, 1);
  expect(ofOneVertex).toBeGreaterThan(0);
  expect(ofOneVertex).toBeLessThan(0.1);
});

test("a reach begins at a twentieth of the model, in a short number", () => {
  expect(usualReach(4.3333)).toBe(0.22);
  expect(usualReach(871)).toBe(44);
});
