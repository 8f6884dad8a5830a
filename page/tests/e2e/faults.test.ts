// Tests that work is kept, and that the page says what to do, when the engine, the disk or a file fails.
import { readFileSync, truncateSync, writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { aimAt, distance, gripOf, positionOf, poseOf } from "./grips";
import { Engine, freePort, hashOf, positionsOf, run, Stage, type Person, type StageOptions } from "./harness";

let stage: Stage | undefined;
afterEach(async () => {
  await stage?.close();
  stage = undefined;
});

async function start(options: StageOptions = {}) {
  stage = await Stage.open(options);
  stage.person.page.setDefaultTimeout(20_000);
  return { stage, person: stage.person, folder: stage.folder };
}

/** Paints the bar near its top as a handle, and waits for its gizmo. */
async function paintTop(stage: Stage, person: Person, resolution = 12): Promise<void> {
  const file = stage.folder.file("rest.obj");
  run("sample", "bar", "--resolution", String(resolution), "-o", file);
  const positions = positionsOf(file);
  const far = Array.from({ length: positions.length / 3 }, (_, v) =>
    distance(positionOf(positions, v), [0.1, -0.5, 3.4]),
  );
  const top = await aimAt(person, far.indexOf(Math.min(...far)));
  await person.press("h");
  await person.stroke([top, [top[0] - 10, top[1] + 6]]);
  await person.page.waitForFunction(
    () => window.meshgraft.editor.tools.activeHandle.value !== null,
    undefined,
    {
      polling: 100, // polls by time, because a background tab draws no frames
    },
  );
  await person.settle();
}

async function moveUp(person: Person, by: number): Promise<void> {
  for (const key of ["g", "z", ...String(by), "Enter"]) await person.press(key);
  await person.settle();
}

async function saveEditAs(person: Person, name: string): Promise<void> {
  await person.press("Control+Shift+s");
  await person.page.getByRole("dialog").getByRole("textbox").fill(name);
  await person.press("Enter");
}

const bar = { "bar.obj": ["bar", "--resolution", "12"] };

test("two tabs: each has its own session, and neither loses what the other does", async () => {
  const { stage, person: one, folder } = await start({ models: bar });
  const model = hashOf(folder.file("bar.obj"));
  await paintTop(stage, one);
  await moveUp(one, 1);

  const two = await stage.tab();
  two.page.setDefaultTimeout(20_000);
  await two.opened();
  expect(await two.page.evaluate(() => window.meshgraft.editor.state.value?.handles)).toEqual([]);
  expect(await two.page.evaluate(() => window.meshgraft.editor.offer.value)).toBeNull(); // tab one has it
  await paintTop(stage, two);
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
  await two.page.getByText(/is there already/).waitFor();
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
  const { stage, person, folder } = await start({ models: bar, words: ["--port", port] });
  const { page } = person;
  await paintTop(stage, person);
  await moveUp(person, 1);
  const ball = await gripOf(person, "ball");
  await page.mouse.move(...ball);
  await page.mouse.down();
  await page.mouse.move(ball[0] + 30, ball[1] - 20, { steps: 5 });
  await stage.engine.stop("SIGKILL");
  await page.mouse.move(ball[0] + 60, ball[1] - 40, { steps: 5 });
  await page.mouse.up();
  await page.getByText("The engine does not answer").waitFor();
  expect(await page.getByText("Your work is safe").count()).toBeGreaterThan(0);

  stage.engine = await Engine.start(["--port", port, folder.file("bar.obj")]);
  await page.getByText("The engine was started again").waitFor();
  expect(await page.getByText(/it offers to restore/).count()).toBe(1);
  await person.screenshot("faults-started-again");
  page.once("dialog", (dialog) => void dialog.accept());
  await page.goto(stage.engine.url);
  await page.getByText("Go on where you were?").waitFor();
  await person.click("Restore");
  await person.settle();
  expect((await poseOf(person))?.translate).toEqual([0, 0, 1]); // an unfinished drag is not a change
  await person.screenshot("faults-restored");
  for (let i = 0; i < 2; ++i) await person.press("Control+z");
  await person.settle();
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.undo)).toBeNull();
  await person.press("Control+Shift+z");
  await person.press("Control+Shift+z");
  await person.settle();
  expect((await poseOf(person))?.translate).toEqual([0, 0, 1]);
  // Requests are reset while the killed engine's socket closes, and refused afterwards.
  expect(person.complaints.filter((text) => !/ERR_CONNECTION_(REFUSED|RESET)|WebSocket|403/.test(text))).toEqual([]);
}, 120_000);

test("a full disk is told with a remedy, and the work is kept", async () => {
  const { stage, person, folder } = await start({
    models: { "bar.obj": ["bar", "--resolution", "30"] },
    mostKilobytes: 48,
  });
  const { page } = person;
  await paintTop(stage, person, 30);
  await moveUp(person, 1);
  writeFileSync(folder.file("out.obj"), "the earlier file");
  await person.press("Control+e");
  await page.getByLabel("Format").selectOption(".obj");
  await page.getByRole("dialog").getByRole("textbox").fill("out");
  await page.getByRole("dialog").getByRole("button", { name: "Export", exact: true }).click();
  await page.getByRole("button", { name: "Replace", exact: true }).click();
  const failure = page.getByRole("dialog").getByRole("alert");
  await failure.waitFor();
  await person.screenshot("faults-full-disk");
  expect(await failure.textContent()).toMatch(/out\.obj/);
  expect(await failure.textContent()).toMatch(/room|space|another place/i);
  expect(readFileSync(folder.file("out.obj"), "utf8")).toBe("the earlier file");
  await person.press("Escape");
  expect((await poseOf(person))?.translate).toEqual([0, 0, 1]);
  await moveUp(person, 1);
  await saveEditAs(person, "small"); // small enough for the limit on files
  await page.getByText("Saved", { exact: true }).waitFor();
  await stage.engine.stop("SIGTERM");
  run("run", folder.file("small.json"), "-o", folder.file("after.obj"));
  expect(Math.max(...positionsOf(folder.file("after.obj")))).toBeGreaterThan(
    Math.max(...positionsOf(folder.file("bar.obj"))) + 1,
  );
}, 120_000);

test("a model that is replaced while it is open is told of when saving", async () => {
  const { stage, person, folder } = await start({ models: bar });
  const { page } = person;
  await paintTop(stage, person);
  await moveUp(person, 1);
  run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
  await saveEditAs(person, "edit");
  await page.getByText(/is another file than the one that was opened/).waitFor();
  await person.screenshot("faults-model-replaced");
  expect(await page.evaluate(() => window.meshgraft.editor.state.value?.model.vertices)).toBe(
    positionsOf(folder.file("rest.obj")).length / 3,
  );
}, 120_000);

test("a dropped file of 2 GB is refused at once, and nobody's memory grows", async () => {
  const { stage, person, folder } = await start();
  const { page } = person;
  const big = folder.file("big.ply");
  writeFileSync(big, "ply\n");
  truncateSync(big, 2 ** 31);
  const residentMB = () => {
    const status = readFileSync(`/proc/${stage.engine.process.pid}/status`, "utf8");
    return Number(/VmHWM:\s+(\d+)/.exec(status)?.[1]) / 1024;
  };
  const before = residentMB();
  const began = performance.now();
  await person.drop([big]);
  await page
    .getByRole("alert")
    .getByText(/are not sent through the browser/)
    .waitFor();
  expect(performance.now() - began).toBeLessThan(3000);
  expect(residentMB() - before).toBeLessThan(20);
  const heap = await page.evaluate(
    () => (performance as Performance & { memory?: { usedJSHeapSize: number } }).memory?.usedJSHeapSize ?? 0,
  );
  expect(heap).toBeLessThan(200e6);
  await person.screenshot("faults-too-large");
  expect(await page.getByRole("alert").textContent()).toMatch(/--folder/);
  await person.click("Close the message");
  await stage.openSample("bar", 8);
}, 120_000);

test("a second model on the command line is shown beside the first one as a part", async () => {
  const { stage, person, folder } = await start({
    models: { "bust.ply": ["bust", "--resolution", "40"], "head.ply": ["head", "--resolution", "40"] },
  });
  const { page } = person;
  const state = () => page.evaluate(() => window.meshgraft.editor.state.value);
  expect((await state())?.parts.map(({ name }) => name)).toEqual(["head"]);
  expect((await state())?.undo).toBeNull();
  expect((await state())?.dirty).toBe(false);
  await page.waitForFunction(() => window.meshgraft.editor.graft.loops.value.size === 2);
  await person.rests();
  await person.screenshot("faults-two-models-open");
  await person.click("Graft head");
  await page.waitForFunction(
    () => window.meshgraft.editor.isIdle() && window.meshgraft.editor.graft.report.value?.seam !== undefined,
  );
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await person.settle();
  await saveEditAs(person, "both");
  await page.getByText("Saved", { exact: true }).waitFor();
  run("run", folder.file("both.json"), "-o", folder.file("both.ply"));
  expect(JSON.parse(run("info", folder.file("both.ply"), "--json"))).toMatchObject({
    components: 1,
    closed: true,
  });
  expect(stage.person.complaints).toEqual([]);
}, 120_000);

test("several dropped files: the first is the model, the others are parts", async () => {
  const { stage, person, folder } = await start();
  const { page } = person;
  const files = ["bust", "head", "cylinder"].map((name) => {
    run("sample", name, "--resolution", "30", "-o", folder.file(`${name}.ply`));
    return folder.file(`${name}.ply`);
  });
  await person.drop(files);
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.parts.length === 2, undefined, {
    timeout: 30_000,
  });
  await person.settle();
  const state = await page.evaluate(() => window.meshgraft.editor.state.value);
  expect(state?.model.name).toBe("bust");
  expect(state?.parts.map(({ name }) => name).sort()).toEqual(["cylinder", "head"]);
  await stage.person.rests();
  await person.screenshot("faults-dropped-several");
  expect(stage.person.complaints).toEqual([]);
}, 120_000);
