import { expect, test } from "vitest";
import { EditorHarness, Engine, freePort, run } from "./harness";

async function openAndMove(harness: EditorHarness): Promise<void> {
  const { page } = harness.user;
  await harness.user.ready();
  await page.getByRole("button", { name: /bar\.obj/ }).first().click();
  await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.ask({ do: "handle", what: "add", name: "top", select: { half_space: { point: [0, 0, 1.5], normal: [0, 0, 1] } }, reach: 1 });
    await editor.pose({ top: { translate: [0.5, 0, 0] } });
  });
  await harness.user.settle();
}

test("a connection that is lost comes back with all changes", async () => {
  const harness = await EditorHarness.open();
  const { user, folder } = harness;
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await user.page.reload();
    await openAndMove(harness);
    await user.page.evaluate(() => window.meshgraft.editor["connection"]["socket"]?.close());
    await user.page.getByText("Reconnected.").waitFor();
    await user.settle();
    const handles = await user.page.evaluate(() => window.meshgraft.editor.state.value?.handles);
    expect(handles?.map(({ name, pose }) => ({ name, pose }))).toEqual([{ name: "top", pose: { translate: [0.5, 0, 0] } }]);
    expect(await user.page.getByRole("alertdialog").count()).toBe(0);
  } finally {
    await harness.close();
  }
});

test("an engine that is killed: the page says so, and the next one offers to restore", async () => {
  const port = await freePort();
  const harness = await EditorHarness.open({ dark: true, words: ["--port", port] });
  const { user, folder } = harness;
  const { page } = user;
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await page.reload();
    await openAndMove(harness);
    await harness.engine.stop("SIGKILL");
    await page.getByText("meshgraft does not answer").waitFor();
    await user.screenshot("panels-lost");

    harness.engine = await Engine.start(["--port", port, folder.file("bar.obj")]);
    await page.getByText("meshgraft was restarted").waitFor();
    await user.screenshot("panels-started-again");
    page.once("dialog", (dialog) => void dialog.accept()); // leaves despite unsaved changes
    await page.goto(harness.engine.url);
    await page.getByText("Restore unsaved work?").waitFor();
    await user.screenshot("panels-restore");
    await user.click("Restore");
    await page.waitForFunction(() => window.meshgraft.editor.state.value?.handles.length === 1);
    await user.settle();
    const pose = await page.evaluate(() => window.meshgraft.editor.state.value?.handles[0]?.pose);
    expect(pose).toEqual({ translate: [0.5, 0, 0] });
    await page.waitForFunction(() => document.title.startsWith("●"));
  } finally {
    await harness.close();
  }
});

test("the token leaves the address and the history, and a reload still has it", async () => {
  const harness = await EditorHarness.open();
  const { page } = harness.user;
  try {
    expect(new URL(harness.engine.url).searchParams.get("token")).toMatch(/^[0-9a-f]{32}$/);
    expect(page.url()).toBe(`${new URL(harness.engine.url).origin}/`);
    const isConnected = () => page.waitForFunction(() => window.meshgraft.editor.link.value === "open");
    await isConnected();
    await page.reload();
    await isConnected();
    await page.evaluate(() => sessionStorage.clear());
    await page.reload();
    await page.getByText("The address is incomplete").waitFor();
    await harness.user.screenshot("panels-without-token");
  } finally {
    await harness.close();
  }
});

test("a page that is loaded again has what it had, with all changes", async () => {
  const harness = await EditorHarness.open();
  const { user, folder } = harness;
  const { page } = user;
  page.on("dialog", (dialog) => void dialog.accept()); // leaves despite unsaved changes
  const handles = () => page.evaluate(() => window.meshgraft.editor.state.value?.handles.map(({ pose }) => pose));
  const again = async () => {
    await page.reload();
    await page.waitForFunction(() => (window.meshgraft.editor.state.value?.handles.length ?? 0) > 0);
    await user.settle();
  };
  try {
    run("sample", "bar", "--resolution", "8", "-o", folder.file("bar.obj"));
    await page.reload();
    await openAndMove(harness);
    await again();
    await page.getByText("The page was reloaded.").waitFor();
    expect(await handles()).toEqual([{ translate: [0.5, 0, 0] }]);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.dirty)).toBe(true);
    expect(await page.getByRole("dialog").count()).toBe(0);
    // Saved work comes back from its edit file.
    const edit = folder.file("bar_edit.json");
    await page.evaluate((edit) => window.meshgraft.editor.ask({ do: "save", edit }), edit);
    await again();
    expect(await handles()).toEqual([{ translate: [0.5, 0, 0] }]);
    expect(await page.evaluate(() => window.meshgraft.editor.state.value?.edit)).toBe(edit);
    expect(user.complaints).toEqual([]);
  } finally {
    await harness.close();
  }
});

test("leaving with unsaved work asks, and without does not", async () => {
  const harness = await EditorHarness.open();
  const { page } = harness.user;
  try {
    const asked: string[] = [];
    page.on("dialog", (dialog) => {
      asked.push(dialog.type());
      void dialog.accept();
    });
    await harness.openSample("bar", 8);
    await page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name: "Handle", exact: true }).click();
    await page.reload();
    expect(asked).toEqual([]);
    await page.waitForFunction(() => window.meshgraft?.editor.welcome.value !== null);
    await harness.openSample("bar", 8);
    await page.evaluate(async () => void (await window.meshgraft.editor.ask({ do: "group", name: "all of it", select: "all" })));
    await page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name: "Handle", exact: true }).click(); // browsers ask only after a user's action
    await page.reload();
    expect(asked).toEqual(["beforeunload"]);
  } finally {
    await harness.close();
  }
});
