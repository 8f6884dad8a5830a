import { expect, test } from "vitest";
import { isFoundBy, ownModels } from "../../src/app/own_models";

const file = (path: string) => ({ path, unsaved: false });
const files = { read: ["/m"], files: [file("/m/part 10.ply"), file("/m/part 2.ply"), file("/m/a.json")] };

test("own models are the recent ones, those of the command line, then those of the folders by name, each once", () => {
  expect(ownModels(["/m/part 10.ply"], ["/m/a.json", "/other/b.ply"], files)).toEqual([
    "/m/part 10.ply", "/m/a.json", "/other/b.ply", "/m/part 2.ply",
  ]);
});

test("a recent file that is gone is left out, where its folder could be read", () => {
  expect(ownModels(["/m/gone.ply", "/m/within/c.ply"], [], { read: ["/m"], files: [] })).toEqual(["/m/within/c.ply"]);
});

test("a search ignores case, accents and the order of words", () => {
  expect(isFoundBy("bar model")("model_bar.ply")).toBe(true);
  expect(isFoundBy("uni")("Üniform.ply")).toBe(true);
  expect(isFoundBy("\u00e9")("e\u0301.ply")).toBe(true); // one letter, written in two ways
  expect(isFoundBy(" SCAN ")("my scan.ply")).toBe(true);
  expect(isFoundBy("scan 2")("scan 1.ply")).toBe(false);
  expect(isFoundBy("")("anything")).toBe(true);
});
