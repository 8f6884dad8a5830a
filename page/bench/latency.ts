// Measures the time from pointer to picture, and from a file to the first picture. `make bench-page` prints Markdown.
import { cpus, loadavg } from "node:os";
import type { Page } from "playwright-core";
import { gripOf } from "../tests/e2e/grips";
import { closeBrowser, EditorHarness, run, startBrowser } from "../tests/e2e/harness";
import { recordPictures, recordStretches, type Picture, type Records } from "./probe";

const size = { width: 1280, height: 800 };
/** Numbers of triangles, and the resolutions of the sample that has them. */
const sizes = [
  ["10,000", 67],
  ["100,000", 200],
  ["1,000,000", 625],
  ["2,000,000", 885],
] as const;
/** Method, its label, and the radius of the region in diagonals of the model's box. */
const methods = [
  ["ft05", "ft05, in the shader", 0.8],
  ["ft05", "ft05, in the shader", 0.3],
  ["corotational", "corotational, streamed", 0.3],
] as const;

/** Times of a picture, ms; `engine` and `transfer`: undefined where the shader moves the surface. */
interface Shares {
  total: number;
  engine: number | undefined;
  transfer: number | undefined;
  page: number;
  gpu: number;
}

/** Returns the time that stretches of work have in common with a span. */
function workIn(records: Records, from: number, to: number): number {
  let sum = 0;
  for (const { begin, end } of records.stretches) sum += Math.max(0, Math.min(end, to) - Math.max(begin, from));
  return sum;
}

/** Splits the time between pointer and picture; undefined for a picture without a new pose. */
function sharesOf(picture: Picture, records: Records): Shares | undefined {
  const { at, pose, drawn, end } = picture;
  if (at !== undefined) {
    const page = workIn(records, at, drawn);
    return { total: end - at, engine: undefined, transfer: undefined, page, gpu: end - at - page };
  }
  const asked = records.asked.find((one) => one.pose === pose);
  const arrival = records.arrivals.find((one) => one.pose === pose);
  if (asked === undefined || arrival === undefined) return undefined;
  const { engineMs: engine, received } = arrival;
  const page = workIn(records, asked.at, asked.sent) + workIn(records, received, drawn);
  const transfer = Math.max(0, received - asked.sent - engine);
  return { total: end - asked.at, engine, transfer, page, gpu: end - asked.at - engine - transfer - page };
}

function firstOfEach(pictures: readonly Picture[]): Picture[] {
  const seen = new Set<number>();
  return pictures.filter(({ at, pose }) => {
    const key = at ?? pose ?? -1;
    const isNew = !seen.has(key);
    seen.add(key);
    return isNew;
  });
}

function quantile(values: readonly number[], share: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? NaN;
}

/** "median (95th percentile)", or a dash without values */
function spread(values: readonly number[]): string {
  if (values.length === 0) return "–";
  const digits = (x: number) => (x < 10 ? x.toFixed(1) : x.toFixed(0));
  return `${digits(quantile(values, 0.5))} (${digits(quantile(values, 0.95))})`;
}

async function openMeasured(resolution: number): Promise<{ harness: EditorHarness; row: string[] }> {
  await startBrowser(true);
  const harness = await EditorHarness.open({ size, before: (page) => page.addInitScript(recordStretches) });
  const model = harness.folder.file("octopus.ply");
  run("sample", "octopus", "--resolution", `${resolution}`, "-o", model);
  const { page } = harness.user;
  await page.evaluate(recordPictures);
  const begin = await page.evaluate(() => performance.now());
  const opened = await page.evaluate(async (path) => {
    const { editor, viewport } = window.meshgraft;
    const begin = performance.now();
    const isThere = () => viewport.main?.object.parent !== null && viewport.main !== undefined;
    const first = new Promise<number>((shown) =>
      viewport.onDrawn.add(({ end }) => isThere() && shown(end - begin)),
    );
    if (!(await editor.open({ do: "open", path })))
      throw new Error(editor.messages.value.map(({ told }) => told.problem).join("; "));
    return first;
  }, model);
  await harness.user.settle();
  await page.waitForTimeout(3000);
  const longest = await page.evaluate((begin) => {
    const since = window.records.longTasks.filter((task) => task.begin >= begin);
    return Math.max(0, ...since.map((task) => task.end - task.begin));
  }, begin);
  const heap = await heapOf(page);
  if (process.env["MESHGRAFT_BENCH_DETAIL"] !== undefined) {
    const long = await page.evaluate(
      (from) => window.records.stretches.filter(({ begin, end }) => begin >= from && end - begin > 20), begin);
    for (const { kind, begin, end } of long) process.stderr.write(`  ${kind} at ${begin.toFixed(0)}: ${(end - begin).toFixed(0)} ms\n`);
  }
  const triangles = await page.evaluate(() => window.meshgraft.viewport.main?.triangleCount ?? 0);
  const row = [
    triangles.toLocaleString("en"),
    (opened / 1000).toFixed(1),
    longest === 0 ? "< 50" : longest.toFixed(0),
    (heap / 2 ** 20).toFixed(0),
  ];
  return { harness, row };
}

/** Returns the number of bytes, with those in arrays. */
async function heapOf(page: Page): Promise<number> {
  const session = await page.context().newCDPSession(page);
  const usage = (await session.send("Runtime.getHeapUsage")) as { usedSize: number; backingStorageSize?: number };
  await session.detach();
  return usage.usedSize + (usage.backingStorageSize ?? 0);
}

async function makeHandle(page: Page, method: string, reach: number): Promise<number> {
  await page.evaluate(async ([method, reach]) => {
    const { editor, viewport } = window.meshgraft;
    const surface = viewport.main;
    if (surface === undefined) throw new Error("nothing is shown");
    const { rest } = surface;
    const length = surface.box.diagonal;
    let tip = 0;
    for (let v = 0; v < rest.length / 3; ++v) if ((rest[3 * v] ?? 0) > (rest[3 * tip] ?? 0)) tip = v;
    const far = (v: number) => Math.hypot(...[0, 1, 2].map((k) => (rest[3 * v + k] ?? 0) - (rest[3 * tip + k] ?? 0)));
    const vertices: number[] = [];
    for (let v = 0; v < rest.length / 3; ++v) if (far(v) < 0.04 * length) vertices.push(v);
    if (editor.offer.value !== null) await editor.ask({ do: "discard" });
    editor.offer.value = null;
    await editor.ask({ do: "reset" });
    await editor.ask({ do: "paint-handle", vertices, reach: reach * length, name: "tip" });
    await editor.ask({ do: "settings", settings: { method } });
    editor.tools.activeHandle.value = "tip";
  }, [method, reach] as const);
  await page.waitForFunction(() => ["ready", "proxy-only"].includes(window.meshgraft.editor.live.value.stage ?? ""),
    undefined, { timeout: 240_000 });
  await page.waitForFunction(
    (linear) => !linear || window.meshgraft.viewport.main?.linear.isReady === true, method === "ft05");
  await page.waitForTimeout(1500);
  return page.evaluate(() => window.meshgraft.editor.state.value?.counts?.free ?? 0);
}

async function dragTip(harness: EditorHarness, seconds: number): Promise<Records> {
  const { page } = harness.user;
  const [x, y] = await gripOf(harness.user, "ball");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 5, y + 5);
  await page.waitForTimeout(300);
  await page.evaluate(() => {
    for (const list of Object.values(window.records)) (list as unknown[]).length = 0;
  });
  const begin = Date.now();
  for (let i = 1; Date.now() - begin < 1000 * seconds; ++i) {
    const turn = i / 12;
    void page.mouse.move(x + 40 * Math.sin(turn), y + 40 * (Math.cos(turn) - 1));
    await new Promise((next) => setTimeout(next, 16));
  }
  const records = await page.evaluate(() => window.records);
  await page.mouse.move(x, y);
  await page.mouse.up();
  return records;
}

async function measureDrags(harness: EditorHarness, triangles: string): Promise<string[][]> {
  const rows: string[][] = [];
  for (const [method, label, reach] of methods) {
    const moving = await makeHandle(harness.user.page, method, reach);
    const records = await dragTip(harness, 10);
    const shares = firstOfEach(records.pictures).flatMap((picture) => sharesOf(picture, records) ?? []);
    const column = (name: keyof Shares) => spread(shares.flatMap((one) => one[name] ?? []));
    const own = spread(shares.map(({ engine = 0, page }) => engine + page));
    rows.push([triangles, moving.toLocaleString("en"), label, `${shares.length}`, column("engine"), column("transfer"),
      column("page"), own, column("gpu"), column("total")]);
    if (process.env["MESHGRAFT_BENCH_DETAIL"] !== undefined) tellStretches(records);
  }
  return rows;
}

/** Prints the page's time by kinds of calls to standard error. */
function tellStretches(records: Records): void {
  for (const kind of ["pointer", "frame", "message", "timer"]) {
    const all = records.stretches.filter((one) => one.kind === kind).map(({ begin, end }) => end - begin);
    const sum = all.reduce((a, b) => a + b, 0);
    process.stderr.write(`  ${kind}: ${all.length}, sum ${sum.toFixed(0)} ms, ${spread(all)}, most ${Math.max(0, ...all).toFixed(1)}\n`);
  }
  for (const picture of records.pictures.slice(-8)) process.stderr.write(`  ${JSON.stringify(picture)}\n`);
  const accuracies = [...new Set(records.arrivals.map(({ accuracy }) => accuracy))];
  for (const accuracy of accuracies)
    process.stderr.write(`  frames ${accuracy}: ${records.arrivals.filter((one) => one.accuracy === accuracy).length}\n`);
}

function table(heads: readonly string[], rows: readonly string[][]): string {
  const line = (cells: readonly string[]) => `| ${cells.join(" | ")} |\n`;
  return line(heads) + `|${heads.map((_, i) => (i === 2 && heads.length > 5 ? "---|" : "---:|")).join("")}\n` + rows.map(line).join("");
}

const digitsOf = (triangles: string) => triangles.replaceAll(",", "");
const wanted = process.argv[2]; // a size alone
if (wanted !== undefined && !sizes.some(([triangles]) => digitsOf(triangles) === wanted)) {
  process.stderr.write(`There is no size ${wanted}. Sizes: ${sizes.map(([triangles]) => digitsOf(triangles)).join(", ")}.\n`);
  process.exit(1);
}
const drags = process.argv[3] !== "open";
const opened: string[][] = [];
const dragged: string[][] = [];
for (const [triangles, resolution] of sizes) {
  if (wanted !== undefined && wanted !== digitsOf(triangles)) continue;
  const { harness, row } = await openMeasured(resolution);
  opened.push(row);
  if (drags && triangles !== "2,000,000") dragged.push(...(await measureDrags(harness, triangles)));
  await harness.close();
  await closeBrowser();
}
const load = (loadavg()[0] ?? 0).toFixed(1);
process.stdout.write(`${cpus().length} cores, SwiftShader (no GPU), page of ${size.width} × ${size.height}; load average ${load}.\n\n`);
process.stdout.write(table(["triangles", "first picture, s", "longest task, ms", "heap, MiB"], opened) + "\n");
if (dragged.length > 0) process.stdout.write(table(["triangles", "free vertices", "method", "pictures", "engine", "transfer", "page", "engine + page",
  "GPU", "total"], dragged));
