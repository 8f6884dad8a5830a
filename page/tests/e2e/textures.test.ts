import { writeFileSync } from "node:fs";
import { deflateSync } from "node:zlib";
import { afterAll, beforeAll, expect, test } from "vitest";
import { EditorHarness, type Point } from "./harness";

let harness: EditorHarness;
beforeAll(async () => {
  harness = await EditorHarness.open({ size: { width: 1000, height: 700 } });
});
afterAll(() => harness.close());

type Colour = readonly [number, number, number];
const red: Colour = [220, 30, 30];
const green: Colour = [30, 190, 40];
const blue: Colour = [30, 50, 220];
const yellow: Colour = [230, 210, 30];

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

/** Returns a PNG of four squares: the upper two from left to right, then the lower two. */
function picture(colours: readonly [Colour, Colour, Colour, Colour], half = 8): Buffer {
  const rows: number[] = [];
  for (let y = 0; y < 2 * half; ++y) {
    rows.push(0);
    for (let x = 0; x < 2 * half; ++x) rows.push(...(colours[2 * Math.floor(y / half) + Math.floor(x / half)] as Colour));
  }
  const chunk = (name: string, data: Buffer) => {
    const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
    const numbers = Buffer.alloc(8);
    numbers.writeUInt32BE(data.length, 0);
    numbers.writeUInt32BE(crc32(body), 4);
    return Buffer.concat([numbers.subarray(0, 4), body, numbers.subarray(4)]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(2 * half, 0);
  head.writeUInt32BE(2 * half, 4);
  head.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.from(rows))), chunk("IEND", Buffer.alloc(0)),
  ]);
}

const count = 24; // squares along an edge of the plate

/** Returns an upright plate from 0 to 1. Each half has the whole picture; a seam of the UVs is between them. */
function plate(material: string): string {
  const lines = ["mtllib plate.mtl"];
  for (let j = 0; j <= count; ++j) for (let i = 0; i <= count; ++i) lines.push(`v ${i / count} ${j / count} 0`);
  for (let side = 0; side < 2; ++side)
    for (let j = 0; j <= count; ++j)
      for (let i = 0; i <= count / 2; ++i) lines.push(`vt ${(2 * i) / count} ${j / count}`);
  lines.push(`usemtl ${material}`);
  const perSide = (count + 1) * (count / 2 + 1);
  for (let j = 0; j < count; ++j)
    for (let i = 0; i < count; ++i) {
      const side = i < count / 2 ? 0 : 1;
      const corner = (x: number, y: number) =>
        `${y * (count + 1) + x + 1}/${side * perSide + y * (count / 2 + 1) + x - (side * count) / 2 + 1}`;
      lines.push(`f ${corner(i, j)} ${corner(i + 1, j)} ${corner(i + 1, j + 1)} ${corner(i, j + 1)}`);
    }
  return lines.join("\n") + "\n";
}

const vertexAt = (i: number, j: number) => j * (count + 1) + i;

async function colourAt([x, y]: Point): Promise<Colour> {
  const { page } = harness.user;
  const shot = (await page.screenshot()).toString("base64");
  return page.evaluate(
    async ([shot, x, y]) => {
      const bytes = Uint8Array.from(atob(shot), (letter) => letter.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes]));
      const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
      canvas?.drawImage(image, 0, 0);
      const scale = image.width / window.innerWidth;
      const [r = 0, g = 0, b = 0] = canvas?.getImageData(Math.round(x * scale), Math.round(y * scale), 1, 1).data ?? [];
      return [r, g, b] as const;
    },
    [shot, x, y] as const,
  );
}

/** Returns the colour of the picture that is nearest to the colour shown at a vertex. */
async function shownAt(i: number, j: number): Promise<Colour | undefined> {
  const shown = await colourAt(await harness.user.screenOf(vertexAt(i, j)));
  const unlike = (colour: Colour) => Math.hypot(...colour.map((part, k) => part - (shown[k] as number)));
  const nearest = [red, green, blue, yellow].sort((a, b) => unlike(a) - unlike(b))[0] as Colour;
  return unlike(nearest) < 90 ? nearest : undefined; // light changes the colour
}

async function open(file: string): Promise<void> {
  const { page } = harness.user;
  await page.evaluate(async (path) => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "open", path });
    editor.view.showRoles.value = false;
    editor.view.shading.value = "texture";
    editor.view.ambientOcclusion.value = false;
    editor.view.grid.value = false;
  }, file);
  await harness.user.settle();
  await page.keyboard.press("Numpad1");
  await harness.user.rests();
}

async function expectPictures(): Promise<void> {
  for (const first of [0, count / 2]) {
    expect(await shownAt(first + 2, 20)).toEqual(red);
    expect(await shownAt(first + 9, 20)).toEqual(green);
    expect(await shownAt(first + 2, 4)).toEqual(blue);
    expect(await shownAt(first + 9, 4)).toEqual(yellow);
  }
}

test("a model is shown with its picture, also when it is bent and after", async () => {
  const { folder, user } = harness;
  writeFileSync(folder.file("squares.png"), picture([red, green, blue, yellow]));
  writeFileSync(folder.file("plate.mtl"), "newmtl squares\nKd 1 1 1\nmap_Kd squares.png\n");
  writeFileSync(folder.file("plate.obj"), plate("squares"));
  await open(folder.file("plate.obj"));
  await user.screenshot("texture");
  await expectPictures();

  const moved = await user.page.evaluate(async (vertices) => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "paint-handle", vertices, reach: 0.5, name: "top" });
    await editor.pose({ top: { translate: [0.1, 0.15, 0] } });
    return true;
  }, Array.from({ length: count + 1 }, (_, i) => vertexAt(i, count)));
  expect(moved).toBe(true);
  await user.settle();
  await user.rests();
  await user.screenshot("texture-bent");
  await expectPictures();

  await user.page.evaluate(() => window.meshgraft.editor.ask({ do: "accept" }));
  await user.settle();
  await user.rests();
  await expectPictures();
  expect(user.complaints).toEqual([]);
});

/** Returns the same plate as a scanner's PLY file. */
function plateOfScan(): string {
  const lines = plate("squares").split("\n");
  const numbers = (of: string) => lines.filter((line) => line.startsWith(`${of} `)).map((line) => line.slice(of.length + 1));
  const uv = numbers("vt");
  const faces = numbers("f").map((line) => line.split(" ").map((corner) => corner.split("/").map((n) => Number(n) - 1)));
  const face = (corners: number[][]) =>
    `4 ${corners.map(([v]) => v).join(" ")} 8 ${corners.map(([, at]) => uv[at ?? 0]).join(" ")}`;
  return ["ply", "format ascii 1.0", "comment TextureFile squares.png", `element vertex ${numbers("v").length}`,
    "property float x", "property float y", "property float z", `element face ${faces.length}`,
    "property list uchar int vertex_indices", "property list uchar float texcoord", "end_header",
    ...numbers("v"), ...faces.map(face), ""].join("\n");
}

test("a scan's PLY is shown with its picture, also as a part", async () => {
  const { folder, user } = harness;
  writeFileSync(folder.file("squares.png"), picture([red, green, blue, yellow]));
  writeFileSync(folder.file("scan.ply"), plateOfScan());
  await open(folder.file("scan.ply"));
  await user.screenshot("texture-ply");
  await expectPictures();

  await user.page.evaluate(async (path) => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "part", what: "add", path });
    editor.graft.mode.value = "graft";
  }, folder.file("scan.ply"));
  await user.page.waitForFunction(() => window.meshgraft.viewport.parts.shown().some(({ surface }) => !surface.mesh.visible));
  await user.rests();
  const drawn = await user.page.evaluate(() => {
    const { editor, viewport } = window.meshgraft;
    const shown = viewport.parts.shown().map(({ surface }) => surface.mesh.visible);
    return { shown, complaints: editor.messages.value.map(({ told }) => told.problem) };
  });
  await user.screenshot("texture-part");
  expect(drawn).toEqual({ shown: [false], complaints: [] }); // its wedges are drawn instead
  expect(user.complaints).toEqual([]);
});

/** Returns an open tube of that radius along y, each side of which shows the whole picture. */
function tube(material: string, radius: number, from: number, to: number): string {
  const around = 24;
  const rings = 8;
  const lines = [`mtllib ${material}.mtl`];
  for (let j = 0; j <= rings; ++j)
    for (let i = 0; i < around; ++i) {
      const angle = (2 * Math.PI * i) / around;
      lines.push(`v ${radius * Math.cos(angle)} ${from + ((to - from) * j) / rings} ${-radius * Math.sin(angle)}`);
    }
  for (let j = 0; j <= rings; ++j) for (let i = 0; i <= around; ++i) lines.push(`vt ${i / around} ${j / rings}`);
  lines.push(`usemtl ${material}`);
  const corner = (i: number, j: number) => `${j * around + (i % around) + 1}/${j * (around + 1) + i + 1}`;
  for (let j = 0; j < rings; ++j)
    for (let i = 0; i < around; ++i)
      lines.push(`f ${corner(i, j)} ${corner(i + 1, j)} ${corner(i + 1, j + 1)} ${corner(i, j + 1)}`);
  return lines.join("\n") + "\n";
}

test("a graft is shown with the pictures of model and part, also before it is accepted", async () => {
  const { folder, user } = harness;
  for (const [name, colour] of [["red", red], ["green", green]] as const) {
    writeFileSync(folder.file(`${name}.png`), picture([colour, colour, colour, colour]));
    writeFileSync(folder.file(`${name}.mtl`), `newmtl ${name}\nKd 1 1 1\nmap_Kd ${name}.png\n`);
  }
  writeFileSync(folder.file("below.obj"), tube("red", 0.5, 0, 1));
  writeFileSync(folder.file("above.obj"), tube("green", 0.5, 2, 3));
  await open(folder.file("below.obj"));
  await user.page.evaluate(async (path) => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "part", what: "add", path, name: "above" });
    editor.graft.mode.value = "graft";
    await editor.ask({ do: "graft", source: "above", pairs: [{ source_loop: { loop: 0 }, target_loop: { loop: 1 } }] });
  }, folder.file("above.obj"));
  const isTextured = () => window.meshgraft.viewport.alsoShown()[0]?.[0].mesh.visible === false;
  await user.page.waitForFunction(isTextured);
  await user.page.evaluate(() => (window.meshgraft.editor.graft.arrangement.value = "result"));
  await user.page.keyboard.press("Numpad1");
  await user.rests();
  await user.screenshot("texture-graft");
  const nearestOf = (shown: Colour) =>
    [red, green].sort((a, b) => Math.hypot(...a.map((c, k) => c - (shown[k] as number))) - Math.hypot(...b.map((c, k) => c - (shown[k] as number))))[0];
  const at = (low: boolean) =>
    user.page.evaluate((low) => {
      const { viewport } = window.meshgraft;
      const [surface] = viewport.alsoShown()[0] ?? [];
      if (surface === undefined) throw new Error("there is no preview");
      const { min, max } = surface.box;
      const middle = min.clone().lerp(max, 0.5).setZ(max.z);
      middle.y = min.y + (low ? 0.15 : 0.85) * (max.y - min.y);
      const { x, y } = viewport.project(middle.add(surface.object.position));
      return [x, y] as const;
    }, low);
  expect(nearestOf(await colourAt(await at(true)))).toEqual(red);
  expect(nearestOf(await colourAt(await at(false)))).toEqual(green);
  await user.page.evaluate(() => (window.meshgraft.editor.view.shading.value = "clay"));
  await user.page.waitForFunction(() => window.meshgraft.viewport.alsoShown()[0]?.[0].mesh.visible === true);
  expect(user.complaints).toEqual([]);
});

test("a model whose picture is not there has checks", async () => {
  const { folder } = harness;
  writeFileSync(folder.file("bare.obj"), plate("nothing"));
  await open(folder.file("bare.obj"));
  await harness.user.screenshot("texture-checks");
  const shades = new Set<string>();
  for (let i = 1; i < count; ++i) shades.add(String(await shownAt(i, 5)));
  expect([...shades]).toEqual(["undefined"]);
  expect(harness.user.complaints).toEqual([]);
});
