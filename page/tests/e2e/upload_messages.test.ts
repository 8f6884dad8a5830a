import { writeFileSync } from "node:fs";
import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, run } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
});
afterAll(() => harness.close());

const damaged: Readonly<Record<string, string>> = {
  "broken.ply": "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n",
  "a face too many.obj": "v 0 0 0\nv 1 0 0\nf 1 2 9\n",
  "odd name.stl": "solid\nfacet",
  "alone.gltf": '{"asset": {"version": "2.0"}, "buffers": [{"uri": "beside.bin", "byteLength": 3}]}',
};

async function expectNamed(name: string): Promise<void> {
  const { page } = harness.user;
  const message = page.getByRole("alert");
  await message.waitFor();
  const text = await message.innerText();
  expect(text).toContain(`The file ${name}`);
  expect(text).not.toMatch(/\/|[0-9a-f]{32}/);
  await harness.user.click("Close the message");
}

test("a refusal of an uploaded file names it as the user does", async () => {
  const { page } = harness.user;
  for (const [name, text] of Object.entries(damaged)) {
    writeFileSync(harness.folder.file(name), text);
    await page.getByLabel("A model of this computer").setInputFiles(harness.folder.file(name));
    await expectNamed(name);
  }
});

test("a refusal of an uploaded part names it as the user does", async () => {
  const { user, folder } = harness;
  run("sample", "bust", "--resolution", "20", "-o", folder.file("bust.obj"));
  await user.page.evaluate((path) => window.meshgraft.editor.open({ do: "open", path }), folder.file("bust.obj"));
  await user.settle();
  await user.page.getByRole("tab", { name: "Graft" }).click();
  await user.drop([folder.file("broken.ply")]);
  await expectNamed("broken.ply");
});
