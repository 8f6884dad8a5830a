// A mesh with defects, for tests of mending.
import { readFileSync, writeFileSync } from "node:fs";

/** Damages an OBJ file: turns some faces over, adds a fin at an edge, and vertices of no face. */
export function damage(file: string, faces: readonly [number, number] = [60, 90]): void {
  const lines = readFileSync(file, "utf8").split("\n");
  const corners = lines.flatMap((line, at) => (line.startsWith("f ") ? [at] : []));
  for (const at of corners.slice(...faces)) {
    const [word, first, ...others] = (lines[at] as string).split(" ");
    lines[at] = [word, first, ...others.reverse()].join(" ");
  }
  const vertices = lines.filter((line) => line.startsWith("v ")).length;
  const [, a = "", b = ""] = (lines[corners[200] as number] as string).split(" ").map((corner) => corner.split("/")[0]);
  const [x, y, z] = ((lines.filter((line) => line.startsWith("v "))[Number(a) - 1] as string).split(" ").slice(1, 4)).map(Number) as [number, number, number];
  const outward = (by: number) => `v ${1.2 * x + by} ${1.2 * y} ${z}`;
  writeFileSync(file, [...lines, outward(0), outward(0.1), outward(0.2), `f ${a} ${b} ${vertices + 1}`, ""].join("\n"));
}
