import { expect, test } from "vitest";
import { stepWords } from "../../src/app/step_words";

test("a step says what it is about", () => {
  expect(stepWords("Graft", { fields: { source: "head", target: "bust" } })).toBe("Graft: head on bust");
  expect(stepWords("Cut", { fields: { mesh: "bust" } })).toBe("Cut: bust");
  expect(stepWords("Cut", { fields: { mesh: "bust" } }, true)).toBe("Cut");
  expect(stepWords("Cut", { fields: { mesh: "bust", result: "bust 2" } })).toBe("Cut: bust, gives bust 2");
  expect(stepWords("Cut", { fields: { mesh: "bust", result: "bust" } })).toBe("Cut: bust");
});
