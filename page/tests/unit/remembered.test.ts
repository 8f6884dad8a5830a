import { afterEach, expect, test, vi } from "vitest";

const stored = new Map<string, string>();
vi.stubGlobal("localStorage", {
  getItem: (key: string) => stored.get(key) ?? null,
  get length() {
    return stored.size;
  },
  key: (i: number) => [...stored.keys()][i] ?? null,
  removeItem: (key: string) => void stored.delete(key),
  setItem: (key: string, value: string) => void stored.set(key, value),
});
const { changeRemembered, remembered, RememberedList } = await import("../../src/app/remembered");
afterEach(() => stored.clear());

test("a list keeps what another tab has stored meanwhile", () => {
  const list = remembered<string[]>("a list", []);
  changeRemembered<string[]>("a list", (before) => [...before, "mine"]);
  stored.set("meshgraft a list", JSON.stringify(["mine", "theirs"])); // as another tab does
  changeRemembered<string[]>("a list", (before) => [...before, "mine, too"]);
  expect(list.value).toEqual(["mine", "theirs", "mine, too"]);
  expect(JSON.parse(stored.get("meshgraft a list") ?? "")).toEqual(["mine", "theirs", "mine, too"]);
});

test("what several tabs add to a list is all kept, in its order, and what one removes is gone", () => {
  const mine = new RememberedList("thing");
  const theirs = new RememberedList("thing");
  mine.add("b");
  theirs.add("a c");
  mine.add("d");
  expect([...new RememberedList("thing").items.value].sort()).toEqual(["a c", "b", "d"]);
  theirs.remove("b");
  expect([...new RememberedList("thing").items.value].sort()).toEqual(["a c", "d"]);
  expect(mine.items.value).toEqual(["b", "d"]); // until the browser tells of the change
  stored.set("meshgraft thing old", "1");
  expect(new RememberedList("thing").items.value[0]).toBe("old");
  expect(new RememberedList("other").items.value).toEqual([]);
});
