import { spawnSync } from "node:child_process";
import { expect, test } from "vitest";

test("the benchmark of the page runs without Vitest, and names its sizes", () => {
  const ended = spawnSync(process.execPath, ["node_modules/vite-node/vite-node.mjs", "bench/latency.ts", "5"], { encoding: "utf8" });
  expect(ended.stderr).toBe("There is no size 5. Sizes: 10000, 100000, 1000000, 2000000.\n");
  expect(ended.status).toBe(1);
});
