import { defineConfig } from "vitest/config";
import type { Reporter } from "vitest/reporters";

/** Names each test that failed first, with its error and place. tools/run_tests.py repeats these lines at its end. */
const secondAttempts: Reporter = {
  onTestCaseResult(test) {
    if (!test.diagnostic()?.flaky) return;
    const [error] = test.result().errors ?? [];
    const line = /[\w/]+\.test\.ts:\d+/.exec(error?.stack ?? "")?.[0];
    const place = line?.split("/page/tests/").at(-1) ?? test.module.moduleId;
    console.log(`passed at a second attempt: ${place}: ${test.name}: ${error?.message.split("\n")[0] ?? ""}`);
  },
};

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
    reporters: ["verbose", secondAttempts],
  },
});
