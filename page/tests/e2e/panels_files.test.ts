import { existsSync, readFileSync, truncateSync, writeFileSync } from "node:fs";
import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, hashOf, positionsOf, run } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
  harness.user.page.setDefaultTimeout(15_000);
});
afterAll(() => harness.close());

const upper = { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } };

async function moveTop(by: number): Promise<void> {
  await harness.user.page.evaluate(
    async ([select, by]) => {
      const { editor } = window.meshgraft;
      const has = editor.state.value?.handles.some(({ name }) => name === "top");
      if (has !== true) await editor.ask({ do: "handle", what: "add", name: "top", select, reach: 1 });
      await editor.pose({ top: { translate: [by, 0, 0] } });
    },
    [upper, by] as const,
  );
  await harness.user.settle();
}

test("an upload is refused before it is sent, cancelled, and opened", async () => {
  const { user, folder } = harness;
  const chooser = user.page.getByLabel("A model of this computer");

  const big = folder.file("big.ply");
  writeFileSync(big, "ply\n");
  truncateSync(big, 2 ** 31);
  let sent = 0;
  await user.page.route("**/upload?*", (route) => {
    ++sent;
    void route.continue();
  });
  await chooser.setInputFiles(big);
  await user.page.getByRole("alert").getByText(/the browser can send up to/).waitFor();
  expect(sent).toBe(0);
  await user.screenshot("panels-upload-refused");
  await user.click("Close the message");
  await user.page.unroute("**/upload?*");

  const model = folder.file("model.obj");
  run("sample", "bar", "--resolution", "8", "-o", model);
  await user.page.route("**/upload?*", () => undefined); // simulates an engine that reads slowly
  await chooser.setInputFiles(model);
  await user.click("Cancel");
  await user.page.getByText("model.obj").waitFor({ state: "hidden" });
  await user.page.unroute("**/upload?*");
  expect(await user.page.evaluate(() => window.meshgraft.editor.isOpen.value)).toBe(false);

  await chooser.setInputFiles(model);
  await user.page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await user.settle(); // the mesh comes before the state
  expect(await user.page.evaluate(() => window.meshgraft.editor.state.value?.model.vertices)).toBe(positionsOf(model).length / 3);
});

test("what is damaged is refused with its problem, and the page goes on", async () => {
  const { user, folder } = harness;
  const broken = folder.file("broken.ply");
  writeFileSync(broken, "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n");
  await user.press("Control+o");
  await user.page.getByRole("button", { name: /broken\.ply/ }).click();
  await user.page.getByRole("alert").waitFor();
  await user.press("Escape");
  await user.click("Close the message");
});

test("saving asks where, then not again, and before it replaces", async () => {
  const { user, folder } = harness;
  await harness.openSample("bar", 8);
  await moveTop(0.5);
  await user.page.waitForFunction((title) => document.title === title, "● bar – meshgraft");
  await user.press("Control+s");
  await user.page.getByRole("dialog").getByRole("textbox").fill("my edit");
  await user.press("Enter");
  await user.page.getByText("Saved", { exact: true }).waitFor();
  await user.screenshot("panels-saved");
  const file = folder.file("my edit.json");
  expect(JSON.parse(readFileSync(file, "utf8")).steps[0].handles[0].pose).toEqual({ translate: [0.5, 0, 0] });
  await user.page.waitForFunction((title) => document.title === title, "bar – meshgraft");
  await user.click("Close the message");

  await moveTop(0.75);
  await user.press("Control+s");
  await user.page.getByText("Saved", { exact: true }).waitFor();
  expect(JSON.parse(readFileSync(file, "utf8")).steps[0].handles[0].pose).toEqual({ translate: [0.75, 0, 0] });
  await user.click("Close the message");

  const other = folder.file("other.json");
  writeFileSync(other, '{"format": "meshgraft-edit", "keep": "me"}');
  const before = hashOf(other);
  await user.press("Control+Shift+s");
  await user.page.getByRole("dialog").getByRole("textbox").fill("other");
  await user.page.getByRole("dialog").getByText("other.json").waitFor();
  await user.press("Enter");
  await user.page.getByText(/already exists/).waitFor();
  await user.screenshot("panels-replace");
  await user.click("Don't replace");
  expect(hashOf(other)).toBe(before);
  await user.page.getByRole("dialog").getByRole("button", { name: "Save", exact: true }).click();
  await user.click("Replace");
  await user.page.getByText("Saved", { exact: true }).waitFor();
  expect(JSON.parse(readFileSync(other, "utf8")).steps[0].handles[0].name).toBe("top");
  await user.click("Close the message");
});

test("what is not saved is asked about before another model is opened", async () => {
  const { user, folder } = harness;
  const { page } = user;
  await harness.openSample("bar", 8);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    if (editor.offer.value !== null) await editor.ask({ do: "discard" });
    editor.offer.value = null;
  });
  await moveTop(0.25);
  const name = () => page.evaluate(() => window.meshgraft.editor.state.value?.name);
  const openTorus = async () => {
    await page.getByRole("dialog").getByText("Samples", { exact: true }).click();
    await page.getByRole("dialog").getByRole("button", { name: /^torus/ }).click();
    await page.getByText("Open torus?").waitFor();
  };
  await user.press("Control+o");
  await openTorus();
  await user.screenshot("panels-leave");
  await user.click("Cancel");
  await page.getByText("Open torus?").waitFor({ state: "hidden" });
  expect(await name()).toBe("bar");
  await openTorus();
  await user.click("Save…");
  await page.getByRole("dialog").getByRole("textbox").fill("before torus");
  await user.press("Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.name === "torus");
  expect(JSON.parse(readFileSync(folder.file("before torus.json"), "utf8")).steps[0].handles[0].name).toBe("top");
  expect(await page.getByRole("dialog").count()).toBe(0);

  await harness.openSample("bar", 8);
  await moveTop(0.25);
  await user.press("Control+o");
  await openTorus();
  await user.click("Open without saving");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.name === "torus");
  await harness.openSample("bar", 8);
  expect(await page.evaluate(() => window.meshgraft.editor.offer.value?.changes)).toBeGreaterThan(0);
  await user.click("Restore");
  await page.waitForFunction(() => (window.meshgraft.editor.state.value?.handles.length ?? 0) > 0);
  await moveTop(0.75); // the next test begins with this pose
});

test("the mesh is exported as it is shown, also as a morph target", async () => {
  const { user, folder } = harness;
  await user.press("Control+e");
  await user.page.getByRole("dialog").getByRole("textbox").fill("bent");
  await user.page.getByLabel("Format").selectOption(".obj"); // a name that was typed stays
  await user.screenshot("panels-export");
  await user.page.getByRole("dialog").getByRole("button", { name: "Export", exact: true }).click();
  await user.page.getByText("Exported", { exact: true }).waitFor();
  const bent = positionsOf(folder.file("bent.obj"));
  const rest = folder.file("rest.obj");
  run("sample", "bar", "--resolution", "8", "-o", rest);
  const straight = positionsOf(rest);
  const shift = (v: number) => (bent[3 * v] ?? NaN) - (straight[3 * v] ?? NaN);
  let held = 0;
  for (let v = 0; v < straight.length / 3; ++v)
    if ((straight[3 * v + 2] ?? 0) >= 1.5) {
      ++held;
      expect(shift(v)).toBeCloseTo(0.75, 5);
    }
  expect(held).toBeGreaterThan(8);
  await user.click("Close the message");

  await user.press("Control+e");
  await user.page.getByLabel("Format").selectOption(".glb");
  await user.page.getByRole("switch", { name: "As a morph target" }).check();
  await user.page.getByLabel("Name of the morph target").fill("lean");
  await user.page.getByRole("dialog").getByRole("button", { name: "Export", exact: true }).click();
  await user.page.getByText("Exported", { exact: true }).waitFor();
  const glb = folder.file("bar_edited.glb");
  expect(existsSync(glb)).toBe(true);
  expect(readFileSync(glb, "latin1")).toContain('"lean"');
  expect(user.complaints).toEqual([]);
});
