// Installs the packages of package-lock.json, unless they are there. npm ci begins by deleting what is there, and
// another build of the same checkout may be using it.
//
//     node tools/install.mjs NPM
import { spawnSync } from "node:child_process";
import { existsSync, statSync, utimesSync } from "node:fs";

const installed = "node_modules/.package-lock.json";
const time = (file) => statSync(file).mtimeMs;
const isCurrent = () =>
  existsSync(installed) && ["package.json", "package-lock.json"].every((file) => time(file) <= time(installed));

if (!isCurrent()) {
  const { status, error } = spawnSync(process.argv[2], ["ci", "--loglevel=error", "--no-audit", "--no-fund"], {
    stdio: "inherit",
  });
  if (error) console.error(error.message);
  if (status !== 0) process.exit(1);
}
utimesSync(installed, new Date(), new Date());
