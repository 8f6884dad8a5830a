import { readFileSync } from "node:fs";
import { afterEach, expect, test } from "vitest";
import { damage } from "./damaged";
import { EditorHarness, run } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

async function openDamaged(options: { dark?: boolean } = {}): Promise<EditorHarness> {
  const opened = await EditorHarness.open({ files: { "bust.obj": ["bust", "--resolution", "60"] }, ...options });
  damage(opened.folder.file("bust.obj"));
  await opened.openFile(opened.folder.file("bust.obj"));
  await opened.user.page.evaluate((path) => window.meshgraft.editor.open({ do: "open", path }), opened.folder.file("bust.obj"));
  await opened.user.opened();
  return opened;
}

/** Returns how many pixels of the view are in the colour of what is lit up. */
async function litPixels({ user }: EditorHarness): Promise<number> {
  await user.page.waitForFunction(() => window.meshgraft.viewport.isFinished);
  const box = await user.page.locator(".view canvas").first().boundingBox();
  if (box === null) throw new Error("nothing is shown");
  const picture = (await user.page.screenshot({ clip: { ...box, width: box.width - 260 } })).toString("base64");
  return user.page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [image.width, image.height];
    const pen = copy.getContext("2d");
    pen?.drawImage(image, 0, 0);
    const data = pen?.getImageData(0, 0, copy.width, copy.height).data ?? new Uint8ClampedArray();
    let lit = 0;
    for (let at = 0; at < data.length; at += 4) {
      const [r, g, b] = [data[at] as number, data[at + 1] as number, data[at + 2] as number];
      if (r > 150 && g < 100 && b < 150 && b > 40 && r - g > 90) ++lit;
    }
    return lit;
  }, picture);
}

test("defects are listed, lit up and mended one kind after the other, and undo brings them back", async () => {
  harness = await openDamaged();
  const { user } = harness;
  const { page } = user;
  const panel = page.getByRole("region", { name: "Defects" });
  const rows = panel.getByRole("listitem");
  const words = async () => (await rows.locator(".defect-words").allInnerTexts()).map((text) => text.replace(/^\d+ /, ""));
  await panel.waitFor();
  expect(await words()).toEqual([
    "Loose vertices of no face",
    "Edge with more than two faces",
    "Edges between faces that face opposite ways",
  ].map((text) => text.charAt(0).toLowerCase() + text.slice(1)));

  const told = page.getByRole("log", { name: "Messages" }).getByRole("status");
  expect(await told.count()).toBe(1);
  await told.getByRole("button", { name: "Close the message" }).click();

  expect(await litPixels(harness)).toBe(0);
  const row = (text: string) => rows.filter({ hasText: text });
  await row("face opposite ways").getByRole("button", { name: "Show" }).click();
  await user.rests();
  await user.screenshot("editor_defects.jpg");
  expect(await litPixels(harness)).toBeGreaterThan(10);
  await row("face opposite ways").getByRole("button", { name: "Hide" }).click();
  await user.rests();
  expect(await litPixels(harness)).toBe(0);

  await row("face opposite ways").getByRole("button", { name: "Show" }).click();
  await row("face opposite ways").getByRole("button", { name: "Mend" }).click();
  await user.rests();
  expect(await words()).toEqual(["loose vertices of no face", "edge with more than two faces"]);
  expect(await litPixels(harness)).toBe(0);
  expect(await told.innerText()).toMatch(/Mended\. .*turned over/);
  const steps = page.getByRole("list", { name: "Steps" });
  await page.getByRole("button", { name: "Steps", exact: false }).first().click();
  expect(await steps.getByRole("listitem").count()).toBe(2);
  await user.press("Control+z");
  await user.settle();
  expect(await rows.count()).toBe(3);
  expect(user.complaints).toEqual([]);
});

test("a message offers to mend all, and the saved edit repeats it", async () => {
  harness = await openDamaged({ dark: true });
  const { user, folder } = harness;
  const { page } = user;
  const panel = page.getByRole("region", { name: "Defects" });
  await user.screenshot("mending-message");
  await page.getByRole("log", { name: "Messages" }).getByRole("button", { name: "Mend all" }).click();
  await panel.waitFor({ state: "detached" });
  await user.settle();
  expect(await page.getByRole("log", { name: "Messages" }).getByRole("status").count()).toBe(1);
  await page.getByRole("button", { name: "Steps", exact: false }).first().click();
  await page.getByRole("button", { name: "1. Mend" }).first().click();
  await user.screenshot("mending-step");
  await page.evaluate(async ([edit, mesh]) => {
    await window.meshgraft.editor.ask({ do: "save", edit, mesh });
  }, [folder.file("edit.json"), folder.file("mended.obj")] as const);
  run("run", folder.file("edit.json"), "-o", folder.file("again.obj"));
  expect(readFileSync(folder.file("again.obj"), "utf8")).toBe(readFileSync(folder.file("mended.obj"), "utf8"));
  expect(() => run("check", folder.file("again.obj"))).not.toThrow();

  // Switching a part off keeps what it would have removed.
  await page.getByRole("switch", { name: "Loose vertices" }).click();
  await panel.waitFor();
  expect(await panel.getByRole("listitem").count()).toBe(1);
  await panel.getByRole("button", { name: "Mend", exact: true }).click();
  await panel.waitFor({ state: "detached" });
  expect(user.complaints).toEqual([]);
});

test("a part has its defects listed where it is grafted", async () => {
  harness = await EditorHarness.open({ files: { "head.obj": ["head", "--resolution", "24"] } });
  const { user, folder } = harness;
  const { page } = user;
  damage(folder.file("head.obj"));
  await harness.openSample("bust", 24);
  await page.evaluate(async (path) => {
    await window.meshgraft.editor.ask({ do: "part", what: "add", path });
  }, folder.file("head.obj"));
  await user.rests();
  expect(await page.getByRole("region", { name: "Defects" }).count()).toBe(0);
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.rests();
  const list = page.getByRole("list", { name: "Defects of head" });
  await list.getByRole("button", { name: "Show" }).last().click();
  await user.rests();
  await user.screenshot("mending-part");
  expect(await litPixels(harness)).toBeGreaterThan(10);
  await page.getByRole("region", { name: "Defects" }).getByRole("button", { name: "Mend all" }).click();
  await list.waitFor({ state: "detached" });
  expect(user.complaints).toEqual([]);
});
