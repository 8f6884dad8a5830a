// Starts the program and its page in Chromium, and acts like a user.
import { execFileSync, spawn, type ChildProcess } from "node:child_process";
import { createHash } from "node:crypto";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { chromium, type Browser, type BrowserContext, type Page } from "playwright-core";
import type { Editor, OpenRequest } from "../../src/app/editor";
import type { GraftView } from "../../src/view/graft/graft_view";
import type { Viewport } from "../../src/view/viewport";

declare global {
  interface Window {
    meshgraft: { editor: Editor; graftView: GraftView; viewport: Viewport };
  }
}

const program = resolve(process.env["MESHGRAFT_PROGRAM"] ?? "../build/release/meshgraft");
const screenshots = resolve(process.env["MESHGRAFT_SCREENSHOTS"] ?? "../out/editor");
const browserPath = process.env["MESHGRAFT_CHROMIUM"] ?? "/usr/bin/chromium";
// Pixels of the screen per pixel of the page, in both directions. Much of the time of these tests goes into drawing
// without a GPU, and less than 1 changes neither the layout nor where the pointer is.
const pixelRatio = Number(process.env["MESHGRAFT_PIXEL_RATIO"] ?? 0.25);

/** The theme in which a test runs unless it asks for one: the light one, but for MESHGRAFT_DARK. */
export const theme = process.env["MESHGRAFT_DARK"] === undefined ? "light" : "dark";

// Runs without a display or a GPU, and without network requests of its own.
const browserArguments = [
  "--no-sandbox",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--disable-quic",
  "--disable-gpu-rasterization", // which Debian turns on, and SwiftShader would do
];

/** Runs the program with these arguments, and returns what it prints. Throws where it fails. */
export function run(...words: string[]): string {
  return execFileSync(program, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

/** A temporary folder for a test; `remove` deletes it. */
export class Folder {
  readonly path = mkdtempSync(join(tmpdir(), "meshgraft-page-"));
  file(name: string): string {
    return join(this.path, name);
  }
  remove(): void {
    rmSync(this.path, { recursive: true, force: true });
  }
}

// The samples that this process has made: the folder of each, by its arguments and its file's name.
const madeSamples = new Map<string, Folder>();
process.once("exit", () => {
  for (const folder of madeSamples.values()) folder.remove();
});

/** Puts the file of a sample there; makes it only once, because large samples take seconds. */
export function putSample(words: readonly string[], file: string): void {
  const name = basename(file);
  const key = [...words, name].join(" ");
  let made = madeSamples.get(key);
  if (made === undefined) {
    made = new Folder();
    run("sample", ...words, "-o", made.file(name));
    madeSamples.set(key, made);
  }
  cpSync(made.path, dirname(file), { recursive: true });
}

// One browser for all tests of a process, because it takes a second to start; each has a context of its own.
let browser: Promise<Browser> | undefined;

async function sharedBrowser(): Promise<Browser> {
  return (await browser)?.isConnected() === true ? (browser as Promise<Browser>) : startBrowser();
}

/**
 * Starts the browser of this process. The GPU puts the page together for users, but in tests SwiftShader would have to
 * do that, too. Without `gpuCompositing`, the page's own thread waits for each picture.
 */
export function startBrowser(gpuCompositing = false): Promise<Browser> {
  const args = gpuCompositing ? browserArguments : [...browserArguments, "--disable-gpu-compositing"];
  return (browser = chromium.launch({ executablePath: browserPath, args }));
}

/** Closes the browser of this process, which ends with it otherwise. */
export async function closeBrowser(): Promise<void> {
  await (await browser)?.close();
  browser = undefined;
}

export function hashOf(file: string): string {
  return createHash("sha256").update(readFileSync(file)).digest("hex");
}

/** Returns the positions of an OBJ file's vertices, 3 numbers each. */
export function positionsOf(file: string): Float64Array {
  const numbers: number[] = [];
  for (const line of readFileSync(file, "utf8").split("\n"))
    if (line.startsWith("v ")) numbers.push(...line.split(/\s+/).slice(1, 4).map(Number));
  return Float64Array.from(numbers);
}

/** Returns a free port, for an engine that is restarted on it. */
export function freePort(): Promise<string> {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.once("error", reject);
    server.listen(0, "127.0.0.1", () => {
      const address = server.address();
      server.close(() => resolve(String(typeof address === "object" ? address?.port : address)));
    });
  });
}

/** A running `meshgraft edit`. */
export class Engine {
  private constructor(
    readonly process: ChildProcess,
    readonly url: string,
  ) {}

  /** `mostKilobytes`: the largest file that it can write, which simulates a full disk. */
  static start(words: string[], options: { mostKilobytes?: number } = {}): Promise<Engine> {
    const port = words.includes("--port") ? [] : ["--port", "0"]; // engines run side by side
    const command = [program, "edit", "--no-browser", ...port, ...words];
    const limited = ["bash", "-c", `ulimit -f ${options.mostKilobytes}; exec "$@"`, "limited", ...command];
    const [first = "", ...rest] = options.mostKilobytes === undefined ? command : limited;
    const child = spawn(first, rest, { stdio: ["ignore", "pipe", "inherit"] });
    return new Promise((resolve, reject) => {
      let printed = "";
      child.stdout.setEncoding("utf8").on("data", (text: string) => {
        printed += text;
        const url = /^http\S+(?=\s)/.exec(printed)?.[0];
        if (url !== undefined) resolve(new Engine(child, url));
      });
      child.once("exit", (code) => reject(new Error(`meshgraft edit ended with ${code}`)));
      child.once("error", reject);
    });
  }

  /** Ends the engine. Resolves with its exit status, or null if the signal ended it. */
  stop(signal: NodeJS.Signals = "SIGINT"): Promise<number | null> {
    if (this.process.exitCode !== null || this.process.signalCode !== null)
      return Promise.resolve(this.process.exitCode);
    const ended = new Promise<number | null>((resolve) => this.process.once("exit", (code) => resolve(code)));
    this.process.kill(signal);
    return ended;
  }
}

export type Point = readonly [number, number];

/** The user of a page, who acts by pointer and keys, and sees its errors. */
export class User {
  /** Counts clicks, strokes and keys, to compare the effort of tasks. */
  actions = 0;
  readonly complaints: string[] = [];

  constructor(readonly page: Page) {
    page.on("pageerror", (error) => this.complaints.push(String(error)));
    page.on("console", (message) => {
      if (message.type() === "error") this.complaints.push(message.text());
    });
  }

  async click(name: string | RegExp): Promise<void> {
    ++this.actions;
    await this.page
      .getByRole("button", { name, exact: typeof name === "string" })
      .first()
      .click();
  }

  async press(keys: string): Promise<void> {
    ++this.actions;
    await this.page.keyboard.press(keys);
  }

  async clickAt(at: Point, options: { shift?: boolean } = {}): Promise<void> {
    ++this.actions;
    if (options.shift === true) await this.page.keyboard.down("Shift");
    await this.page.mouse.click(...at);
    if (options.shift === true) await this.page.keyboard.up("Shift");
  }

  /** Drags through these points with a button held. */
  async stroke(
    points: readonly Point[],
    options: { button?: "left" | "middle" | "right"; steps?: number } = {},
  ): Promise<void> {
    ++this.actions;
    const [first, ...rest] = points;
    if (first === undefined) throw new Error("a stroke without points");
    await this.page.mouse.move(...first);
    await this.page.mouse.down({ button: options.button ?? "left" });
    for (const point of rest) await this.page.mouse.move(...point, { steps: options.steps ?? 6 });
    await this.page.mouse.up({ button: options.button ?? "left" });
  }

  /** Turns the wheel by so many pixels of the page; Chromium takes pixels of the screen. */
  async wheel(by: number): Promise<void> {
    ++this.actions;
    await this.page.mouse.wheel(0, by * pixelRatio);
  }

  /** Drops files of this machine on the page, as from a file manager. */
  async drop(files: readonly string[], [x, y]: Point = [500, 400]): Promise<void> {
    ++this.actions;
    const browser = await this.page.context().newCDPSession(this.page);
    const data = { items: [], files: [...files], dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"] as const)
      await browser.send("Input.dispatchDragEvent", { type, x, y, data });
    await browser.detach();
  }

  /**
   * Returns the screen point of a vertex of the model as shown. The camera and the canvas follow a change with the next
   * picture, so the view must be at rest.
   */
  screenOf(vertex: number): Promise<Point> {
    return this.page.evaluate((v) => {
      const { viewport } = window.meshgraft;
      const surface = viewport.main;
      if (surface === undefined) throw new Error("nothing is shown");
      const at = surface.object.localToWorld(
        surface.object.position
          .clone()
          .set(
            surface.positions[3 * v] ?? 0,
            surface.positions[3 * v + 1] ?? 0,
            surface.positions[3 * v + 2] ?? 0,
          ),
      );
      const { x, y } = viewport.project(at);
      return [x, y] as const;
    }, vertex);
  }

  /** Waits until every request is answered and the shown surface is exact. */
  async settle(): Promise<void> {
    await this.page.waitForFunction(
      () => {
        const { editor } = window.meshgraft;
        if (editor.state.value === null) return false;
        const stage = editor.live.value.stage;
        return (
          editor.isIdle() &&
          (editor.state.value.counts === null ||
            stage === undefined ||
            ["ready", "proxy-only", "failed"].includes(stage))
        );
      },
      undefined,
      { timeout: 90_000 },
    );
  }

  /** Waits until the page is connected and painted, because Chromium drops earlier pointer events. */
  async ready(): Promise<void> {
    await this.page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
    await this.page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
  }

  /** Waits until the page has opened the files of the command line. */
  async opened(): Promise<void> {
    await this.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
    await this.rests();
  }

  /**
   * Waits until the engine has answered all requests and the view is at rest: the camera stands still, and what it
   * sees is drawn. The view must rest for several frames, because an answer of the engine may begin a movement.
   */
  async rests(): Promise<void> {
    if (await this.page.evaluate(() => window.meshgraft.editor.state.value !== null)) await this.settle();
    await this.page.evaluate(async () => {
      const { viewport, editor } = window.meshgraft;
      const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));
      for (let quiet = 0; quiet < 4; ++quiet) {
        await nextFrame();
        if (!viewport.isAtRest || !editor.isIdle()) quiet = -1;
      }
    });
  }

  /** Saves a screenshot: a PNG, or a JPEG if the name says so. */
  async screenshot(name: string): Promise<void> {
    mkdirSync(screenshots, { recursive: true });
    const isJpeg = name.endsWith(".jpg");
    if (isJpeg) await this.rests();
    await this.page.waitForFunction(() => window.meshgraft.viewport.isFinished);
    const path = join(screenshots, isJpeg ? name : `${name}.png`);
    await this.page.screenshot(isJpeg ? { path, type: "jpeg", quality: 85 } : { path });
  }
}

export interface HarnessOptions {
  /** By file name: the arguments of `meshgraft sample`. */
  files?: Readonly<Record<string, readonly string[]>>;
  /** Further files for the command line. */
  models?: Readonly<Record<string, readonly string[]>>;
  words?: string[];
  /** Called with the page before it loads. */
  before?: (page: Page) => Promise<unknown>;
  mostKilobytes?: number;
  size?: { width: number; height: number };
  dark?: boolean;
  /** Starts as the first time, with the guided tour. */
  firstStart?: boolean;
  /** Emulates a screen that fingers touch. */
  touch?: boolean;
}

/** An engine, a page and its user for one test; `close` ends all. */
export class EditorHarness {
  private constructor(
    readonly folder: Folder,
    private readonly context: BrowserContext,
    public engine: Engine,
    readonly user: User,
  ) {}

  static async open(options: HarnessOptions = {}): Promise<EditorHarness> {
    const folder = new Folder();
    for (const [file, sample] of Object.entries({ ...options.files, ...options.models }))
      putSample(sample, folder.file(file));
    const models = Object.keys(options.models ?? {}).map((file) => folder.file(file));
    const engine = await Engine.start(
      ["--folder", folder.path, ...(options.words ?? []), ...models],
      options,
    );
    const context = await (await sharedBrowser()).newContext({
      viewport: options.size ?? { width: 1280, height: 800 },
      deviceScaleFactor: pixelRatio,
      colorScheme: options.dark === true ? "dark" : theme,
      reducedMotion: "reduce",
      hasTouch: options.touch === true,
      isMobile: options.touch === true,
    });
    context.setDefaultTimeout(60_000); // a loaded machine takes its time
    if (options.firstStart !== true) await context.addInitScript(() => localStorage.setItem("meshgraft tour seen", "true"));
    const page = await context.newPage();
    const user = new User(page);
    await options.before?.(page);
    await page.goto(engine.url);
    await user.ready();
    if (models.length > 0) await user.opened();
    return new EditorHarness(folder, context, engine, user);
  }

  /** Opens a built-in model by a request, without the start screen, and waits until it is drawn. */
  openSample(sample: string, resolution?: number): Promise<void> {
    return this.openBy(resolution === undefined ? { do: "open", sample } : { do: "open", sample, resolution });
  }

  /** Opens a file by a request, and waits until it is drawn. */
  openFile(path: string): Promise<void> {
    return this.openBy({ do: "open", path });
  }

  private async openBy(request: OpenRequest): Promise<void> {
    await this.user.page.evaluate(async (request) => void (await window.meshgraft.editor.ask(request)), request);
    await this.user.opened();
  }

  /** Opens another tab of the same engine. */
  async tab(): Promise<User> {
    const user = new User(await this.user.page.context().newPage());
    await user.page.goto(this.engine.url);
    await user.ready();
    return user;
  }

  /** Saves the mesh and returns its positions: those of the model if there was no edit. */
  async savedPositions(): Promise<Float64Array> {
    const file = this.folder.file("saved.obj");
    await this.user.page.evaluate(async (mesh) => {
      await window.meshgraft.editor.ask({ do: "save", mesh, overwrite: true });
    }, file);
    return positionsOf(file);
  }

  async close(): Promise<void> {
    await this.context.close();
    await this.engine.stop();
    this.folder.remove();
  }
}
