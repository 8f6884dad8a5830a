import { execFileSync } from "node:child_process";
import { chmodSync, existsSync, mkdtempSync, readFileSync, rmSync, utimesSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { expect, onTestFinished, test } from "vitest";

test("packages are installed once, and again after a change of what is wanted", () => {
  const folder = mkdtempSync(join(tmpdir(), "install"));
  onTestFinished(() => rmSync(folder, { recursive: true }));
  const calls = join(folder, "calls"), npm = join(folder, "npm");
  writeFileSync(npm, `#!/bin/sh\necho "$@" >> ${calls}\nmkdir -p node_modules\ntouch node_modules/.package-lock.json\n`);
  chmodSync(npm, 0o755);
  for (const file of ["package.json", "package-lock.json"]) writeFileSync(join(folder, file), "{}");
  const install = () =>
    execFileSync(process.execPath, [resolve("tools/install.mjs"), npm], { cwd: folder, stdio: "pipe" });
  const installations = () => (existsSync(calls) ? readFileSync(calls, "utf8").match(/^ci /gm)!.length : 0);

  install();
  expect(installations()).toBe(1);
  install();
  expect(installations()).toBe(1);
  const later = new Date(Date.now() + 10_000);
  utimesSync(join(folder, "package-lock.json"), later, later);
  install();
  expect(installations()).toBe(2);
  writeFileSync(npm, "#!/bin/sh\nexit 1\n");
  utimesSync(join(folder, "package.json"), later, new Date(Date.now() + 20_000));
  expect(install).toThrow();
});
