import { describe, expect, test } from "vitest";
import { freeName, tourSteps } from "../../src/app/tour";
import { besideAnchor } from "../../src/panels/tour_bubble";

describe("the tour", () => {
  test("has six bubbles, grafting among them, each with words, an anchor and an action", () => {
    expect(tourSteps.length).toBe(6);
    expect(tourSteps.some(({ title }) => title.startsWith("Graft"))).toBe(true);
    for (const { title, words, anchors, action } of tourSteps) {
      expect(words, title).toMatch(/^[A-Z].*\.$/);
      expect(anchors.length, title).toBeGreaterThan(0);
      expect(action, title).not.toBe("");
    }
  });
  test("gives its handle a name that is free", () => {
    expect(freeName("head", [])).toBe("head");
    expect(freeName("head", ["head", "head 2"])).toBe("head 3");
  });
  test("speaks of fingers where fingers are used", () => {
    for (const { title, words, touchWords = words } of tourSteps) {
      expect(touchWords, title).toMatch(/^[A-Z].*\.$/);
      expect(touchWords, title).not.toMatch(/click|drop|release|press|key|\\/i);
    }
  });
});

describe("a bubble", () => {
  const window = { width: 800, height: 600 };
  const bubble = { width: 300, height: 180 };
  const anchors = [
    { left: 4, top: 100, width: 36, height: 36 },
    { left: 520, top: 50, width: 270, height: 30 },
    { left: 300, top: 560, width: 200, height: 30 },
    { left: 44, top: 46, width: 700, height: 520 },
    { left: 780, top: 590, width: 10, height: 10 },
  ];
  test("stands within the window", () => {
    for (const anchor of anchors) {
      const { left, top } = besideAnchor(anchor, bubble, window);
      expect(left).toBeGreaterThanOrEqual(0);
      expect(top).toBeGreaterThanOrEqual(0);
      expect(left + bubble.width).toBeLessThanOrEqual(window.width);
      expect(top + bubble.height).toBeLessThanOrEqual(window.height);
    }
  });
  test("does not cover what it points at, if there is room at a side", () => {
    for (const anchor of anchors.slice(0, 2)) {
      const { left } = besideAnchor(anchor, bubble, window);
      expect(left >= anchor.left + anchor.width || left + bubble.width <= anchor.left).toBe(true);
    }
  });
});
