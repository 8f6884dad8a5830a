import { mkdirSync, writeFileSync } from "node:fs";
import { zipSync, strToU8 } from "three/examples/jsm/libs/fflate.module.js";
import { afterAll, beforeAll, expect, test } from "vitest";
import { grafted } from "./grafting";
import { EditorHarness, run, type User } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open();
  for (const file of ["bar.obj", "bar.glb"]) run("sample", "bar", "--resolution", "8", "-o", harness.folder.file(file));
  writeFileSync(harness.folder.file("inches.3mf"), threemf("inch"));
  await open("bar.obj");
  await harness.user.click("View");
});
afterAll(() => harness.close());

/** Returns a 3MF file with a tetrahedron, 2 units high. */
function threemf(unit: string): Uint8Array {
  const at = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 2]].map(([x, y, z]) => `<vertex x="${x}" y="${y}" z="${z}"/>`);
  const faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(([a, b, c]) => `<triangle v1="${a}" v2="${b}" v3="${c}"/>`);
  const mesh = `<mesh><vertices>${at.join("")}</vertices><triangles>${faces.join("")}</triangles></mesh>`;
  const xml = '<?xml version="1.0" encoding="UTF-8"?>';
  const types = "http://schemas.openxmlformats.org/package/2006";
  const core = "http://schemas.microsoft.com/3dmanufacturing";
  return zipSync({
    "[Content_Types].xml": strToU8(
      `${xml}<Types xmlns="${types}/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>`,
    ),
    "_rels/.rels": strToU8(
      `${xml}<Relationships xmlns="${types}/relationships"><Relationship Id="rel0" Target="/3D/3dmodel.model" Type="${core}/2013/01/3dmodel"/></Relationships>`,
    ),
    "3D/3dmodel.model": strToU8(
      `${xml}<model unit="${unit}" xmlns="${core}/core/2015/02"><resources><object id="1" type="model">${mesh}</object></resources><build><item objectid="1"/></build></model>`,
    ),
  });
}

async function open(file: string): Promise<void> {
  const { user, folder } = harness;
  await user.page.evaluate((path) => window.meshgraft.editor.open({ do: "open", path }), folder.file(file));
  await user.rests();
}

const statusBar = () => harness.user.page.getByLabel("Status", { exact: true });
const chosenUnit = () => harness.user.page.getByLabel("Unit", { exact: true });

test("lengths have the unit that the file names, and none where it names none", async () => {
  const { user } = harness;
  for (const [file, unit, size] of [
    ["bar.obj", "none", /\d × [\d.]+ × [\d.]+$/],
    ["bar.glb", "m", /\d × [\d.]+ × [\d.]+ m$/],
    ["inches.3mf", "in", /1 × 1 × 2 in$/],
    ["bar.obj", "none", /\d × [\d.]+ × [\d.]+$/],
  ] as const) {
    await open(file);
    expect(await chosenUnit().inputValue(), file).toBe(unit);
    await statusBar().getByText(size).waitFor();
    const scale = await user.page.locator(".view-notes").innerText();
    expect(scale.trim(), file).toMatch(unit === "none" ? /^[\d.]+$/ : new RegExp(`^[\\d.]+ ${unit}$`));
  }
  expect(user.complaints).toEqual([]);
});

test("a part that is grafted on changes no unit", async () => {
  const { user, folder } = harness;
  const { page } = user;
  run("sample", "head", "--resolution", "30", "-o", folder.file("head.glb"));
  await harness.openSample("bust", 30);
  await page.evaluate(async (path) => {
    const { graft } = window.meshgraft.editor;
    graft.mode.value = "graft";
    await graft.addPart({ path }, true);
  }, folder.file("head.glb"));
  await grafted(user);
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await user.settle();
  await statusBar().getByText(/ × [\d.]+$/).waitFor();
  expect(await chosenUnit().inputValue()).toBe("none");
});

test("a unit is chosen for a model, and for all whose files name none", async () => {
  await open("bar.glb");
  await chosenUnit().selectOption("cm");
  await statusBar().getByText(/ cm$/).waitFor();
  await open("bar.obj");
  await statusBar().getByText(/ × [\d.]+$/).waitFor();
  await chosenUnit().selectOption("mm");
  await open("inches.3mf");
  await statusBar().getByText("1 × 1 × 2 in").waitFor();
  await open("bar.obj");
  await statusBar().getByText(/ mm$/).waitFor();
  await chosenUnit().selectOption("none");
  expect(harness.user.complaints).toEqual([]);
});

test("STL and OBJ files are asked for their unit once in each folder, and sizes follow the deformation", async () => {
  const { user, folder } = harness;
  const { page } = user;
  mkdirSync(folder.file("scans"));
  for (const file of ["scans/one.stl", "scans/two.obj"]) run("sample", "bar", "--resolution", "8", "-o", folder.file(file));
  await open("scans/one.stl");
  const question = page.getByRole("region", { name: "Unit of the model" });
  await question.getByText(/^The file names no unit\. The model measures 1 × 1 × 4 –/).waitFor();
  await user.screenshot("units-asked");
  await question.getByRole("button", { name: "cm", exact: true }).click();
  await question.waitFor({ state: "detached" });
  await statusBar().getByText("1 × 1 × 4 cm").waitFor();
  await open("inches.3mf");
  expect(await question.count()).toBe(0); // the file names its unit
  await open("scans/two.obj");
  await statusBar().getByText("1 × 1 × 4 cm").waitFor();
  expect(await question.count()).toBe(0);

  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 1], normal: [0, 0, 1] } }, reach: 1 });
    await editor.pose({ top: { translate: [0, 0, 2] } });
  });
  for (const tab of ["Graft", "Deform"]) {
    await page.getByRole("tab", { name: tab }).click();
    await statusBar().getByText("1 × 1 × 6 cm").waitFor();
  }
  expect(user.complaints).toEqual([]);
});

test("the unit of a dropped file is known in other tabs, open or new", async () => {
  const other = await harness.tab();
  const { user, folder } = harness;
  run("sample", "bar", "--resolution", "9", "-o", folder.file("dropped.stl"));
  const question = (of: User) => of.page.getByRole("region", { name: "Unit of the model" });
  const sizes = (of: User) => of.page.getByLabel("Status", { exact: true });
  const drop = async (of: User) => {
    await of.drop([folder.file("dropped.stl")]);
    await of.page.waitForFunction(() => window.meshgraft.editor.state.value?.name === "dropped.stl");
    await of.rests();
  };
  await user.page.bringToFront();
  await open("bar.glb"); // all saved: a drop then opens at once
  await drop(user);
  await question(user).getByRole("button", { name: "mm", exact: true }).click();
  await sizes(user).getByText("1 × 1 × 4 mm").waitFor();
  for (const tab of [other, await harness.tab()]) {
    await tab.page.bringToFront();
    await drop(tab);
    await sizes(tab).getByText("1 × 1 × 4 mm").waitFor();
    expect(await question(tab).count()).toBe(0);
    expect(tab.complaints).toEqual([]);
    await tab.page.close();
  }
});
