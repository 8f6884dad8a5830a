import { defineConfig } from "vitest/config";

// tests/unit: logic alone; tests/e2e and tests/long: the built program, with its page in Chromium.
export default defineConfig({
  test: {
    include: ["tests/**/*.test.ts"],
    testTimeout: 120_000,
    hookTimeout: 60_000,
    expect: { poll: { timeout: 20_000 } },
    fileParallelism: false,
    // One process for all files of a run, which start the browser once.
    pool: "forks",
    poolOptions: { forks: { singleFork: true } },
    isolate: false,
    reporters: ["verbose"],
  },
});
