// A remedy that names a control of the page has a button that does it, or leads there.
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { describe, expect, test } from "vitest";
import { remedyOf, remedyOfPage, type Remedy } from "../../src/app/remedies";
import { countsFor, fieldsFor, ofFiles, partsSaid, rows } from "./facts_said";

/** Names of panels, fields, tools and buttons, and acts that have one. */
const controls = [
  /\bMore (settings|options)\b/,
  /\bunder (Symmetry|Steps|Parts|Pairs|Defects|View|Method|Graft)\b/,
  /\b(Proxy vertices|Solver|Flat areas|Iterations|Weld seams|Reach|Placement|Twist|Spin|Base|Defects|Symmetry|Point handle)\b/,
  /\b(Make fixed|Make region|Clear fixed area|Flip normals|Split, keep both|Automatic sizes|As a morph target|Save as)\b/,
  /\b(part library|symmetry off|spin|tilt of|strength below)\b/i,
  /\b(size of|smaller size|size may help|size or shape may help)\b/i,
  /\bcut (it|the part) (open|again)\b/i,
  /\b(close the holes|leave the cut open|close the cut flat|mend|undo|accept or cancel|paint)\b/i,
  /\brepair\b/i,
  /\badd (a|its) folder\b/i,
  /\b(Save under|Draw (again|on|the curve)|Switch (on|off)|click (a|one) (boundary )?loop|click one of its loops)\b/i,
];
const namesControl = (text: string) => controls.some((words) => words.test(text));

const sources = fileURLToPath(new URL("../../src/", import.meta.url));
const files = readdirSync(sources, { recursive: true, encoding: "utf8" }).filter((file) => /\.tsx$|settings\.ts$/.test(file));
const allText = files.map((file) => readFileSync(sources + file, "utf8")).join("\n");

function checkPlace({ place }: Remedy): void {
  for (const name of [place?.section, place?.more, place?.control])
    if (name !== undefined) expect(allText).toMatch(new RegExp(`(label|title): ?"${name}"|(label|title)="${name}"`));
}

describe("a remedy that names a control has a button", () => {
  test.each(rows.filter(({ id }) => !ofFiles(id)).map((row) => [row.id, row] as const))("%s", (id, row) => {
    for (const count of countsFor(row)) {
      const fields = fieldsFor(row, count);
      const { problem, remedy } = partsSaid(row, fields);
      const button = remedyOf({ id, fields });
      if (namesControl(remedy) || (/ may help/.test(problem) && namesControl(problem))) expect(button, remedy).toBeDefined();
      if (button === undefined) continue;
      expect(button.label).toMatch(/^[A-Z]/);
      expect(button.label).not.toMatch(/undefined|NaN|null/);
      checkPlace(button);
    }
  });
  test("and so has what the page notes itself", () => {
    for (const button of Object.values(remedyOfPage)) checkPlace(button);
  });
});
