import { copyFileSync, writeFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { EditorHarness } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

const defective = `v 0 0 0
v 1 0 0
v 0 1 0
v 5 5 5
v 0 0 1
v 0 0 -1
f 1 2 3
f 1 2 5
f 1 2 6
`;

test("a file of another format than its name says is opened, and told of by the name that the user knows", async () => {
  harness = await EditorHarness.open({ files: { "scan.ply": ["bust", "--resolution", "30"] } });
  const { user, folder } = harness;
  copyFileSync(folder.file("scan.ply"), folder.file("scan.obj"));
  await user.drop([folder.file("scan.obj")]);
  await user.opened();
  const told = user.page.getByRole("log", { name: "Messages" }).getByRole("status");
  await told.waitFor();
  expect(await told.count()).toBe(1);
  expect(await told.locator("strong").innerText()).toBe("The file scan.obj holds PLY, not OBJ");
  await user.screenshot("opening-other-format");
  expect(user.complaints).toEqual([]);
});

test("an edit that other methods made is opened, and told of", async () => {
  harness = await EditorHarness.open({ files: { "bust.ply": ["bust", "--resolution", "30"] } });
  const { user, folder } = harness;
  const edit = {
    format: "meshgraft-edit",
    version: 2,
    made_with: { version: "0.0.1", methods: 1000 },
    inputs: { bust: { file: "bust.ply" } },
    steps: [{ kind: "deform", mesh: "bust" }],
  };
  writeFileSync(folder.file("old.json"), JSON.stringify(edit));
  await user.page.evaluate(async (path) => {
    await window.meshgraft.editor.open({ do: "open", path });
  }, folder.file("old.json"));
  await user.opened();
  const told = user.page.getByRole("log", { name: "Messages" }).getByRole("status");
  await told.waitFor();
  expect(await told.innerText()).toContain("The edit was made with meshgraft 0.0.1");
  await user.screenshot("opening-other-methods");
});

test("a dropped file keeps its name, and its defects are told until that is dismissed", async () => {
  harness = await EditorHarness.open({ files: { "bust.ply": ["bust", "--resolution", "30"] } });
  const { user, folder } = harness;
  const { page } = user;
  const name = () => page.evaluate(() => window.meshgraft.editor.state.value?.name ?? "");
  writeFileSync(folder.file("Bär 熊 (2).obj"), defective);
  await user.drop([folder.file("Bär 熊 (2).obj")]);
  await user.opened();
  expect(await name()).toBe("Bär 熊 (2).obj");
  const told = page.getByRole("log", { name: "Messages" }).getByRole("status");
  await told.waitFor();
  const words = await told.innerText();
  expect(words).toContain("more than two faces");
  expect(words).toContain("can disturb editing");
  await user.screenshot("opening-defects");
  await told.getByRole("button", { name: /dismiss|close/i }).first().click();
  await told.waitFor({ state: "detached" });

  copyFileSync(folder.file("bust.ply"), folder.file("büste.ply"));
  await page.evaluate(async (path) => {
    await window.meshgraft.editor.open({ do: "open", path });
  }, folder.file("büste.ply"));
  await user.settle();
  expect(await name()).toBe("büste.ply");
  expect(await told.count()).toBe(0);
  const up = () => page.evaluate(() => window.meshgraft.editor.state.value?.up);
  expect(await up()).toBe("z"); // as the file of a sample says
  await user.screenshot("opening-upright");
  expect(user.complaints).toEqual([]);
});

test("the unit of a dropped file is asked for once for that file, and not for others", async () => {
  const sample = ["bar", "--resolution", "8"];
  harness = await EditorHarness.open({ files: { "one.stl": sample, "two.stl": sample } });
  const { user, folder } = harness;
  const { page } = user;
  const question = page.getByRole("region", { name: "Unit of the model" });
  const size = (words: string) => page.getByLabel("Status", { exact: true }).getByText(words, { exact: true }).waitFor();
  const open = async (file: string) => {
    await user.drop([folder.file(file)]);
    await page.waitForFunction((name) => window.meshgraft.editor.state.value?.name === name && window.meshgraft.editor.isIdle(), file);
    await user.rests();
  };
  await open("one.stl");
  await question.getByText("This is remembered for this file.").waitFor();
  await user.screenshot("opening-unit-of-dropped");
  await question.getByRole("button", { name: "cm", exact: true }).click();
  await size("1 × 1 × 4 cm");
  await page.reload();
  await user.ready();
  await user.opened();
  await size("1 × 1 × 4 cm");
  expect(await question.count()).toBe(0);
  await open("two.stl");
  await size("1 × 1 × 4");
  await question.getByRole("button", { name: "mm", exact: true }).click();
  await open("one.stl");
  await size("1 × 1 × 4 cm");
  expect(await question.count()).toBe(0);
  expect(user.complaints).toEqual([]);
});
