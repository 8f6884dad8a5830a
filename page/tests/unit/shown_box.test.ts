import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { boxOfPositions, followShownBox } from "../../src/app/shown_box";
import { exportName } from "../../src/panels/file_dialogs";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

test("a box leaves out positions that are not finite, and is moved by the offset", () => {
  expect(boxOfPositions([0, 0, 0, NaN, 9, 9, 1, 2, 3], [10, 0, 0])).toEqual({ low: [10, 0, 0], high: [11, 2, 3] });
  expect(boxOfPositions([], [0, 0, 0])).toBeNull();
});

test("the box follows the shown positions, and the model that is opened next", () => {
  const onFrame = new Set<() => void>();
  const surface = { positions: Float32Array.of(0, 0, 0, 1, 1, 1), offset: [0, 0, 0] as const, version: 0 };
  const viewport = { main: surface as typeof surface | undefined, onFrame };
  const box = followShownBox(viewport as Parameters<typeof followShownBox>[0]);
  const draw = () => {
    onFrame.forEach((call) => call());
    vi.runAllTimers();
  };
  draw();
  expect(box.value?.high).toEqual([1, 1, 1]);
  surface.positions[5] = 4;
  draw();
  expect(box.value?.high).toEqual([1, 1, 1]); // nothing says that they changed
  surface.version = 1;
  draw();
  expect(box.value?.high).toEqual([1, 1, 4]);
  viewport.main = undefined;
  draw();
  expect(box.value).toBeNull();
});

test("an export is named after the edit file, or after the model", () => {
  expect(exportName({ name: "bust.ply", edit: "" })).toBe("bust_edited");
  expect(exportName({ name: "bust.ply", edit: "/models/portrait.json" })).toBe("portrait");
  expect(exportName(null)).toBe("model_edited");
  expect(exportName({ name: "bust.ply", edit: "" }, "bust 2")).toBe("bust_2");
});
