import { expect, test } from "vitest";
import { newName } from "../../src/app/folders";

test("a part is saved under a name that no other file has", () => {
  expect(newName("left arm", new Set())).toBe("left_arm.ply");
  expect(newName("left arm", new Set(["left_arm.ply", "left_arm_2.ply"]))).toBe("left_arm_3.ply");
  expect(newName("cactus", new Set(["cactus.obj"]))).toBe("cactus_2.ply");
  expect(newName("a/b", new Set(["a.ply"]))).toBe("a_b.ply");
  expect(newName(".h", new Set())).toBe("h.ply"); // lists leave hidden files out
  expect(newName("..", new Set())).toBe("part.ply");
});
