import { expect, test } from "vitest";
import { Engine, freePort, run, Stage } from "./harness";

async function openAndMove(stage: Stage): Promise<void> {
  const { page } = stage.person;
  await page.getByRole("button", { name: /bar\.obj/ }).first().click();
  await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } }, reach: 1 });
    await editor.pose({ top: { translate: [0.5, 0, 0] } });
  });
  await stage.person.settle();
}

test("a connection that is lost comes back with all changes", async () => {
  const stage = await Stage.open();
  const { person, folder } = stage;
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await person.page.reload();
    await openAndMove(stage);
    await person.page.evaluate(() => window.meshgraft.editor["connection"]["socket"]?.close());
    await person.page.getByText("The connection was lost, and is back.").waitFor();
    await person.settle();
    const handles = await person.page.evaluate(() => window.meshgraft.editor.state.value?.handles);
    expect(handles?.map(({ name, pose }) => ({ name, pose }))).toEqual([{ name: "top", pose: { translate: [0.5, 0, 0] } }]);
    expect(await person.page.getByRole("alertdialog").count()).toBe(0);
  } finally {
    await stage.close();
  }
});

test("an engine that is killed: the page says so, and the next one offers to restore", async () => {
  const port = await freePort();
  const stage = await Stage.open({ dark: true, words: ["--port", port] });
  const { person, folder } = stage;
  const { page } = person;
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await page.reload();
    await openAndMove(stage);
    await stage.engine.stop("SIGKILL");
    await page.getByText("The engine does not answer").waitFor();
    await person.screenshot("panels-lost");

    stage.engine = await Engine.start(["--port", port, folder.file("bar.obj")]);
    await page.getByText("The engine was started again").waitFor();
    await person.screenshot("panels-started-again");
    page.once("dialog", (dialog) => void dialog.accept()); // leaves despite unsaved changes
    await page.goto(stage.engine.url);
    await page.getByText("Go on where you were?").waitFor();
    await person.screenshot("panels-restore");
    await person.click("Restore");
    await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles.length === 1);
    await person.settle();
    const pose = await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose);
    expect(pose).toEqual({ translate: [0.5, 0, 0] });
    await page.waitForFunction(() => document.title.startsWith("●"));
  } finally {
    await stage.close();
  }
});

test("a page that is loaded again has what it had, with all changes", async () => {
  const stage = await Stage.open();
  const { person, folder } = stage;
  const { page } = person;
  page.on("dialog", (dialog) => void dialog.accept()); // leaves despite unsaved changes
  const handles = () => page.evaluate(() => window.meshgraft.editor.state.value?.handles.map(({ pose }) => pose));
  const again = async () => {
    await page.reload();
    await page.waitForFunction(() => (window.meshgraft.editor.state.value?.handles.length ?? 0) > 0);
    await person.settle();
  };
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await page.reload();
    await openAndMove(stage);
    await again();
    await page.getByText("The page was loaded again.").waitFor();
    expect(await handles()).toEqual([{ translate: [0.5, 0, 0] }]);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.dirty)).toBe(true);
    expect(await page.getByRole("dialog").count()).toBe(0);
    // Saved work comes back from its edit file.
    const edit = folder.file("bar_edit.json");
    await page.evaluate((edit) => window.meshgraft.editor.ask({ do: "save", edit }), edit);
    await again();
    expect(await handles()).toEqual([{ translate: [0.5, 0, 0] }]);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.edit)).toBe(edit);
    expect(person.complaints).toEqual([]);
  } finally {
    await stage.close();
  }
});

test("leaving with unsaved work asks, and without does not", async () => {
  const stage = await Stage.open();
  const { page } = stage.person;
  try {
    const asked: string[] = [];
    page.on("dialog", (dialog) => {
      asked.push(dialog.type());
      void dialog.accept();
    });
    await stage.openSample("bar", 8);
    await page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name: "Handle", exact: true }).click();
    await page.reload();
    expect(asked).toEqual([]);
    await page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
    await stage.openSample("bar", 8);
    await page.evaluate(async () => void (await window.meshgraft.editor.ask({ do: "group", name: "all of it", select: "all" })));
    await page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name: "Handle", exact: true }).click(); // browsers ask only after a user's action
    await page.reload();
    expect(asked).toEqual(["beforeunload"]);
  } finally {
    await stage.close();
  }
});
