// The editor for a program that waits for the result, and in a frame of another page.
import { existsSync, readFileSync } from "node:fs";
import { createServer, request as ask, type Server } from "node:http";
import { connect, type AddressInfo } from "node:net";
import { afterEach, expect, test } from "vitest";
import { EditorHarness, Engine, Folder, run, User } from "./harness";

const openings: (() => unknown)[] = [];
afterEach(async () => {
  for (const close of openings.splice(0).reverse()) await close();
});

async function openWaitedFor(): Promise<EditorHarness & { result: string }> {
  const results = new Folder();
  openings.push(() => results.remove());
  const result = results.file("edit.json");
  const harness = await EditorHarness.open({
    models: { "bar.ply": ["bar", "--resolution", "8"] },
    words: ["--result", result],
  });
  openings.push(() => harness.close());
  return Object.assign(harness, { result });
}

async function bend({ user }: EditorHarness, along: number): Promise<void> {
  await user.page.evaluate(async (along) => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 3.5], normal: [0, 0, 1] } }, reach: 2 });
    await editor.pose({ top: { translate: [along, 0, 0] } });
  }, along);
  await user.settle();
}

const translation = (file: string) => JSON.parse(readFileSync(file, "utf8")).steps[0].handles[0].pose.translate;
const exitOf = ({ engine }: EditorHarness) =>
  new Promise((resolve) => (engine.process.exitCode === null ? engine.process.once("exit", resolve) : resolve(engine.process.exitCode)));

test("Done hands the edit to the program that waits, and ends the editor", async () => {
  const harness = await openWaitedFor();
  const { user, result } = harness;
  expect(existsSync(result)).toBe(false); // nothing was changed yet
  await bend(harness, 0.5);
  expect(translation(result)).toEqual([0.5, 0, 0]);
  expect(await user.page.title()).not.toMatch(/^●/); // nothing is left to save
  await user.screenshot("waited-for");
  const ended = exitOf(harness);
  await user.click("Done");
  await user.page.getByRole("alertdialog", { name: "Done" }).waitFor();
  expect(await ended).toBe(0);
  expect(translation(result)).toEqual([0.5, 0, 0]);
  await user.screenshot("handed-back");
  expect(await user.page.getByText("meshgraft does not answer").count()).toBe(0);
  expect(user.complaints).toEqual([]);
});

test("a page that is loaded again goes on, and one that is closed ends the editor", async () => {
  const harness = await openWaitedFor();
  const { user, result } = harness;
  await bend(harness, 0.5);
  await user.page.reload();
  await user.page.waitForFunction(() => (window.meshgraft?.editor.state.value?.handles.length ?? 0) > 0);
  await user.settle();
  expect(translation(result)).toEqual([0.5, 0, 0]);
  const ended = exitOf(harness);
  await user.page.close();
  expect(await ended).toBe(0);
  expect(translation(result)).toEqual([0.5, 0, 0]);
});

test("without a program that waits there is no such button", async () => {
  const harness = await EditorHarness.open({ models: { "bar.ply": ["bar", "--resolution", "8"] } });
  openings.push(() => harness.close());
  const buttons = harness.user.page.getByRole("button");
  expect(await buttons.filter({ hasText: /^Done$/ }).count()).toBe(0);
  expect(await harness.user.page.getByRole("button", { name: "Save", exact: true }).count()).toBe(1);
});

/** A web server for the test; resolves with it and its origin. */
async function serve(server: Server): Promise<string> {
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  openings.push(() => (server.closeAllConnections(), server.close()));
  return `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
}

/** A page with one frame, whose address the function tells. */
const pageWithFrame = (address: () => string) =>
  createServer((_, response) =>
    response.setHeader("Content-Type", "text/html").end(`<iframe src="${address()}" width="1200" height="700"></iframe>`),
  );

async function policyOf(engine: Engine): Promise<string | null> {
  return (await fetch(engine.url)).headers.get("content-security-policy");
}

test("only pages of the given origin may frame the editor", async () => {
  const folder = new Folder();
  openings.push(() => folder.remove());
  run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.ply"));
  let address = "";
  const friend = await serve(pageWithFrame(() => address));
  const stranger = await serve(pageWithFrame(() => address));
  const harness = await EditorHarness.open();
  openings.push(() => harness.close());
  const engine = await Engine.start([folder.file("bar.ply"), "--frame-origin", friend]);
  openings.push(() => engine.stop());
  address = engine.url;
  expect(await policyOf(harness.engine)).toContain("frame-ancestors 'none'");
  expect(await policyOf(engine)).toMatch(new RegExp(`frame-ancestors ${friend}$`));

  const user = new User(await harness.user.page.context().newPage());
  await user.page.goto(friend);
  await user.page.frames()[1]?.waitForFunction(() => window.meshgraft?.viewport.main !== undefined);
  expect(user.complaints).toEqual([]);
  await user.page.goto(stranger);
  await expect.poll(() => user.complaints.join()).toContain("frame-ancestors");
  expect(await user.page.frames()[1]?.evaluate(() => "meshgraft" in window).catch(() => false)).toBe(false);
  await expect(Engine.start(["--frame-origin", "http://a.example/; script-src *"])).rejects.toThrow("ended with 2");
});

/** Forwards what lies below /proxy/PORT/ to that port with all headers, as the proxies of notebooks do. */
function proxy(): Server {
  const target = (url = "") => /^\/base\/proxy\/(\d+)(\/.*)$/.exec(url) ?? ["", "0", ""];
  const server = createServer((request, response) => {
    const [, port, path] = target(request.url);
    const { method, headers } = request;
    const forwarded = ask({ port, path, method, headers, host: "127.0.0.1" }, (answer) => {
      response.writeHead(answer.statusCode ?? 0, answer.headers);
      answer.pipe(response);
    });
    forwarded.on("error", () => response.destroy()); // the editor may have ended
    request.pipe(forwarded);
  });
  server.on("upgrade", (request, socket) => {
    const [, port, path] = target(request.url);
    const head = request.rawHeaders.map((word, i) => word + (i % 2 === 0 ? ": " : "\r\n")).join("");
    const other = connect(Number(port), "127.0.0.1", () => other.write(`GET ${path} HTTP/1.1\r\n${head}\r\n`));
    socket.pipe(other).pipe(socket);
    for (const end of [socket, other]) end.on("error", () => (socket.destroy(), other.destroy()));
  });
  return server;
}

test("a proxy serves the page below a path of its own", async () => {
  const harness = await EditorHarness.open();
  openings.push(() => harness.close());
  const folder = new Folder();
  openings.push(() => folder.remove());
  run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.ply"));
  const origin = await serve(proxy());
  const engine = await Engine.start([folder.file("bar.ply"), "--frame-origin", origin]);
  openings.push(() => engine.stop());
  const { port, search } = new URL(engine.url);
  const user = new User(await harness.user.page.context().newPage());
  await user.page.goto(`${origin}/base/proxy/${port}/${search}`);
  await user.ready();
  await user.opened();
  const uploaded = folder.file("other.ply");
  run("sample", "head", "--resolution", "8", "-o", uploaded);
  await user.drop([uploaded]);
  await user.page.waitForFunction(() => window.meshgraft.editor.state.value?.name.startsWith("other"));
  expect(user.complaints).toEqual([]);
});
