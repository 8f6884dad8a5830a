import { expect, test } from "vitest";
import { isFoundBy, ownModels } from "../../src/app/own_models";

const files = (...names: string[]) => names.map((name) => ({ path: `/m/${name}`, name, unsaved: false }));
const folder = { whole: ["/m"], files: files("part 10.ply", "lamps/a lamp.ply", "part 2.ply", "a.json") };
const any = () => true;

test("own models are the recent ones, those of the command line, then those of the folders by name, each once", () => {
  expect(ownModels(["/m/part 10.ply"], ["/m/a.json", "/other/b.ply"], folder, any)).toEqual([
    "/m/part 10.ply", "/m/a.json", "/other/b.ply", "/m/part 2.ply", "/m/lamps/a lamp.ply",
  ]);
});

test("a search finds names, and names of folders within", () => {
  expect(ownModels(["/n/lamp.ply"], [], folder, isFoundBy("lamp"))).toEqual(["/n/lamp.ply", "/m/lamps/a lamp.ply"]);
  expect(ownModels([], [], folder, isFoundBy("lamps"))).toEqual(["/m/lamps/a lamp.ply"]);
  expect(ownModels([], [], folder, isFoundBy("m"))).toEqual(["/m/lamps/a lamp.ply"]); // not the folder that was listed
});

test("a recent file that is gone is left out, where all files of its folder are known", () => {
  const recent = ["/m/gone.ply", "/m/within/gone.ply", "/n/unknown.ply"];
  expect(ownModels(recent, [], { whole: ["/m"], files: [] }, any)).toEqual(["/n/unknown.ply"]);
  expect(ownModels(recent, [], { whole: [], files: [] }, any)).toEqual(recent);
});

test("a search ignores case, accents and the order of words", () => {
  expect(isFoundBy("bar model")("model_bar.ply")).toBe(true);
  expect(isFoundBy("uni")("Üniform.ply")).toBe(true);
  expect(isFoundBy("\u00e9")("e\u0301.ply")).toBe(true); // one letter, written in two ways
  expect(isFoundBy(" SCAN ")("my scan.ply")).toBe(true);
  expect(isFoundBy("scan 2")("scan 1.ply")).toBe(false);
  expect(isFoundBy("")("anything")).toBe(true);
});
