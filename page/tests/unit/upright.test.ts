import { expect, it } from "vitest";
import { axes, opposite, uprightOf, vectorOf, withFront, withUp, type Upright } from "../../src/app/upright";
import { ViewSettings } from "../../src/app/view_settings";

const dot = (a: number[], b: number[]) => a.reduce((sum, x, k) => sum + x * (b[k] as number), 0);
const all: Upright[] = axes.flatMap((up) => axes.filter((front) => front.slice(-1) !== up.slice(-1)).map((front) => ({ up, front })));

it("has a front at a right angle to what is up", () => {
  expect(uprightOf("z")).toEqual({ up: "z", front: "-y" });
  expect(uprightOf("y")).toEqual({ up: "y", front: "z" });
  expect(uprightOf("z", "x")).toEqual({ up: "z", front: "x" });
  expect(uprightOf("x", "-x")).toEqual({ up: "x", front: "-y" });
});

it("takes any side as the front or as the upper side, and turns by a right angle at most", () => {
  expect(all.length).toBe(24);
  for (const upright of all)
    for (const side of axes) {
      const turned = withFront(upright, side);
      expect(turned.front).toBe(side);
      expect(dot(vectorOf(turned.up), vectorOf(side))).toBe(0);
      if (side.slice(-1) !== upright.up.slice(-1)) expect(turned.up).toBe(upright.up);
      const raised = withUp(upright, side);
      expect(raised.up).toBe(side);
      expect(dot(vectorOf(raised.front), vectorOf(side))).toBe(0);
      if (side.slice(-1) !== upright.front.slice(-1)) expect(raised.front).toBe(upright.front);
      expect(withFront(withFront(upright, upright.up), opposite(upright.up)).up).not.toBe(upright.up);
    }
});

it("is remembered for each model", () => {
  const view = new ViewSettings();
  view.model.value = "/models/horse.ply";
  expect([view.up.value, view.front.value]).toEqual(["auto", undefined]);
  view.stand({ up: "-x", front: "y" });
  expect([view.up.value, view.front.value]).toEqual(["-x", "y"]);
  view.model.value = "/models/cat.ply";
  expect([view.up.value, view.front.value]).toEqual(["auto", undefined]);
  view.model.value = "/models/horse.ply";
  view.standAsInFile();
  expect([view.up.value, view.front.value]).toEqual(["auto", undefined]);
});
