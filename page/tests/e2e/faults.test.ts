// Tests that work is kept, and that the page says what to do, when the engine, the disk or a file fails.
import { readFileSync, truncateSync, writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { aimAt, distance, gripOf, positionOf, poseOf } from "./grips";
import { EditorHarness, Engine, freePort, hashOf, positionsOf, run, type HarnessOptions, type User } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

async function start(options: HarnessOptions = {}) {
  harness = await EditorHarness.open(options);
  return { harness, user: harness.user, folder: harness.folder };
}

/** Paints the bar near its top as a handle, and waits for its gizmo. */
async function paintTop(harness: EditorHarness, user: User, resolution = 12): Promise<void> {
  const file = harness.folder.file("rest.obj");
  run("sample", "bar", "--resolution", String(resolution), "-o", file);
  const positions = positionsOf(file);
  const far = Array.from({ length: positions.length / 3 }, (_, v) =>
    distance(positionOf(positions, v), [0.1, -0.5, 3.4]),
  );
  const top = await aimAt(user, far.indexOf(Math.min(...far)));
  await user.press("h");
  await user.stroke([top, [top[0] - 10, top[1] + 6]]);
  await user.page.waitForFunction(
    () => window.meshgraft.editor.tools.activeHandle.value !== null,
    undefined,
    {
      polling: 100, // polls by time, because a background tab draws no frames
    },
  );
  await user.settle();
}

async function moveUp(user: User, by: number): Promise<void> {
  for (const key of ["g", "z", ...String(by), "Enter"]) await user.press(key);
  await user.settle();
}

async function saveEditAs(user: User, name: string): Promise<void> {
  await user.press("Control+Shift+s");
  await user.page.getByRole("dialog").getByRole("textbox").fill(name);
  await user.press("Enter");
}

const bar = { "bar.obj": ["bar", "--resolution", "12"] };

test("two tabs: each has its own session, and neither loses what the other does", async () => {
  const { harness, user: one, folder } = await start({ models: bar });
  const model = hashOf(folder.file("bar.obj"));
  await paintTop(harness, one);
  await moveUp(one, 1);

  const two = await harness.tab();
  await two.opened();
  expect(await two.page.evaluate(() => window.meshgraft.editor.state.value?.handles)).toEqual([]);
  expect(await two.page.evaluate(() => window.meshgraft.editor.offer.value)).toBeNull(); // tab one has it
  await paintTop(harness, two);
  await moveUp(two, 5);
  await two.screenshot("faults-second-tab");
  await one.page.bringToFront();
  expect((await poseOf(one))?.translate).toEqual([0, 0, 1]);
  await moveUp(one, 1);
  expect((await poseOf(one))?.translate).toEqual([0, 0, 2]);

  // Both tabs save under one name. The second is asked first; the first is told when it saves again.
  await saveEditAs(one, "work");
  await one.page.getByText("Saved", { exact: true }).waitFor();
  await two.page.bringToFront();
  await saveEditAs(two, "work");
  await two.page.getByText(/already exists/).waitFor();
  await two.click("Replace");
  await two.page.getByText("Saved", { exact: true }).waitFor();
  const theirs = hashOf(folder.file("work.json"));
  await one.page.bringToFront();
  await moveUp(one, 1);
  await one.press("Control+s");
  await one.page.getByText("work.json was changed elsewhere").waitFor();
  await one.screenshot("faults-changed-elsewhere");
  expect(hashOf(folder.file("work.json"))).toBe(theirs);
  await one.click("Save as…");
  await one.page.getByRole("dialog").getByRole("textbox").fill("mine");
  await one.press("Enter");
  await one.page.getByText("mine.json").first().waitFor();
  await one.settle();
  const heights = ["mine", "work"].map(
    (name) =>
      JSON.parse(readFileSync(folder.file(`${name}.json`), "utf8")).steps[0].handles[0].pose.translate[2],
  );
  expect(heights).toEqual([3, 5]);
  expect(hashOf(folder.file("bar.obj"))).toBe(model);
  expect([...one.complaints, ...two.complaints]).toEqual([]);
}, 180_000);

test("an engine killed in mid-drag: the page says what to do, and the next one restores what was done", async () => {
  const port = await freePort();
  const { harness, user, folder } = await start({ models: bar, words: ["--port", port] });
  const { page } = user;
  await paintTop(harness, user);
  await moveUp(user, 1);
  const ball = await gripOf(user, "ball");
  await page.mouse.move(...ball);
  await page.mouse.down();
  await page.mouse.move(ball[0] + 30, ball[1] - 20, { steps: 5 });
  await harness.engine.stop("SIGKILL");
  await page.mouse.move(ball[0] + 60, ball[1] - 40, { steps: 5 });
  await page.mouse.up();
  await page.getByText("meshgraft does not answer").waitFor();
  expect(await page.getByText("Your work is safe").count()).toBeGreaterThan(0);

  harness.engine = await Engine.start(["--port", port, folder.file("bar.obj")]);
  await page.getByText("meshgraft was restarted").waitFor();
  expect(await page.getByText(/to restore what was not saved/).count()).toBe(1);
  await user.screenshot("faults-started-again");
  page.once("dialog", (dialog) => void dialog.accept());
  await page.goto(harness.engine.url);
  await page.getByText("Restore unsaved work?").waitFor();
  await user.click("Restore");
  await user.settle();
  expect((await poseOf(user))?.translate).toEqual([0, 0, 1]); // an unfinished drag is not a change
  await user.screenshot("faults-restored");
  for (let i = 0; i < 2; ++i) await user.press("Control+z");
  await user.settle();
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.undo)).toBeNull();
  await user.press("Control+Shift+z");
  await user.press("Control+Shift+z");
  await user.settle();
  expect((await poseOf(user))?.translate).toEqual([0, 0, 1]);
  // Requests are reset while the killed engine's socket closes, and refused afterwards.
  expect(user.complaints.filter((text) => !/ERR_CONNECTION_(REFUSED|RESET)|WebSocket|403/.test(text))).toEqual([]);
});

test("a full disk is told with a remedy, and the work is kept", async () => {
  const { harness, user, folder } = await start({
    models: { "bar.obj": ["bar", "--resolution", "30"] },
    mostKilobytes: 48,
  });
  const { page } = user;
  await paintTop(harness, user, 30);
  await moveUp(user, 1);
  writeFileSync(folder.file("out.obj"), "the earlier file");
  await user.press("Control+e");
  await page.getByLabel("Format").selectOption(".obj");
  await page.getByRole("dialog").getByRole("textbox").fill("out");
  await page.getByRole("dialog").getByRole("button", { name: "Export", exact: true }).click();
  await page.getByRole("button", { name: "Replace", exact: true }).click();
  const failure = page.getByRole("dialog").getByRole("alert");
  await failure.waitFor();
  await user.screenshot("faults-full-disk");
  expect(await failure.textContent()).toMatch(/out\.obj/);
  expect(await failure.getAttribute("data-fact")).toBe("io.file_too_large"); // the limit that stands for the disk
  expect(readFileSync(folder.file("out.obj"), "utf8")).toBe("the earlier file");
  await user.press("Escape");
  expect((await poseOf(user))?.translate).toEqual([0, 0, 1]);
  await moveUp(user, 1);
  await saveEditAs(user, "small"); // small enough for the limit on files
  await page.getByText("Saved", { exact: true }).waitFor();
  await harness.engine.stop("SIGTERM");
  run("run", folder.file("small.json"), "-o", folder.file("after.obj"));
  expect(Math.max(...positionsOf(folder.file("after.obj")))).toBeGreaterThan(
    Math.max(...positionsOf(folder.file("bar.obj"))) + 1,
  );
});

test("a model that is replaced while it is open is told of when saving", async () => {
  const { harness, user, folder } = await start({ models: bar });
  const { page } = user;
  await paintTop(harness, user);
  await moveUp(user, 1);
  run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
  await saveEditAs(user, "edit");
  await page.getByText(/is no longer the one that was opened/).waitFor();
  await user.screenshot("faults-model-replaced");
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.model.vertices)).toBe(
    positionsOf(folder.file("rest.obj")).length / 3,
  );
});

test("a dropped file of 2 GB is refused before it is sent, and nobody's memory grows", async () => {
  const { harness, user, folder } = await start();
  const { page } = user;
  await user.rests();
  const big = folder.file("big.ply");
  writeFileSync(big, "ply\n");
  truncateSync(big, 2 ** 31);
  const peakMB = () => {
    const status = readFileSync(`/proc/${harness.engine.process.pid}/status`, "utf8");
    return Number(/VmHWM:\s+(\d+)/.exec(status)?.[1]) / 1024;
  };
  const before = peakMB();
  const sent: string[] = [];
  page.on("request", (request) => {
    if (request.method() !== "GET") sent.push(`${request.method()} ${request.url()}`);
  });
  await user.drop([big]);
  await page
    .getByRole("alert")
    .getByText(/the browser can send up to/)
    .waitFor();
  expect(sent).toEqual([]);
  expect(peakMB() - before).toBeLessThan(200); // a tenth of the file
  const heap = await page.evaluate(
    () => (performance as Performance & { memory?: { usedJSHeapSize: number } }).memory?.usedJSHeapSize ?? 0,
  );
  expect(heap).toBeLessThan(200e6);
  await user.screenshot("faults-too-large");
  expect(await page.getByRole("alert").textContent()).toMatch(/Add its folder under Folders/);
  await user.click("Close the message");
  await harness.openSample("bar", 8);
});

test("a second model on the command line is shown beside the first one as a part", async () => {
  const { harness, user, folder } = await start({
    models: { "bust.ply": ["bust", "--resolution", "40"], "head.ply": ["head", "--resolution", "40"] },
  });
  const { page } = user;
  const state = () => page.evaluate(() => window.meshgraft.editor.state.value);
  expect((await state())?.parts.map(({ name }) => name)).toEqual(["head"]);
  expect((await state())?.undo).toBeNull();
  expect((await state())?.dirty).toBe(false);
  await page.waitForFunction(() => window.meshgraft.editor.graft.loops.value.size === 2);
  await user.rests();
  await user.screenshot("faults-two-models-open");
  await user.click("Graft head");
  await page.waitForFunction(
    () => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value?.seam !== undefined,
  );
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await user.settle();
  await saveEditAs(user, "both");
  await page.getByText("Saved", { exact: true }).waitFor();
  run("run", folder.file("both.json"), "-o", folder.file("both.ply"));
  expect(JSON.parse(run("info", folder.file("both.ply"), "--json"))).toMatchObject({
    components: 1,
    closed: true,
  });
  expect(harness.user.complaints).toEqual([]);
});

test("several dropped files: the first is the model, the others are parts", async () => {
  const { harness, user, folder } = await start();
  const { page } = user;
  const files = ["bust", "head", "cylinder"].map((name) => {
    run("sample", name, "--resolution", "30", "-o", folder.file(`${name}.ply`));
    return folder.file(`${name}.ply`);
  });
  await user.drop(files);
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.parts.length === 2, undefined, {
    timeout: 30_000,
  });
  await user.settle();
  const state = await page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state?.model.name).toBe("bust");
  expect(state?.parts.map(({ name }) => name).sort()).toEqual(["cylinder", "head"]);
  await harness.user.rests();
  await user.screenshot("faults-dropped-several");
  expect(harness.user.complaints).toEqual([]);
});
