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
}, 120_000);

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
}, 120_000);

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
}, 120_000);
