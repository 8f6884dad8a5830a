import { expect, test } from "vitest";
import { EditorHarness, run } from "./harness";

/** An editor with bar.obj open, and its mark of unsaved changes. */
class Marked {
  private readonly asked: string[] = [];

  private constructor(readonly harness: EditorHarness) {
    this.page.on("dialog", (dialog) => {
      this.asked.push(dialog.type());
      void dialog.accept();
    });
  }

  static async open(): Promise<Marked> {
    const marked = new Marked(await EditorHarness.open());
    const { page, harness } = marked;
    run("sample", "bar", "--resolution", "8", "-o", harness.folder.file("bar.obj"));
    await page.reload();
    await harness.user.ready();
    await page.getByRole("button", { name: /bar\.obj/ }).first().click();
    await page.waitForFunction(() => window.meshgraft.viewport.main !== undefined);
    await harness.user.settle();
    return marked;
  }

  get page() {
    return this.harness.user.page;
  }

  /** Makes one change. */
  async change(name: string): Promise<void> {
    await this.page.evaluate((name) => window.meshgraft.editor.ask({ do: "group", name, select: "all" }), name);
    await this.harness.user.settle();
  }
  async press(keys: string): Promise<void> {
    await this.harness.user.press(keys);
    await this.harness.user.settle();
  }
  async loseConnection(): Promise<void> {
    await this.page.evaluate(() => {
      const { editor } = window.meshgraft;
      let isLost = false;
      const isBack = new Promise<void>((resolve) =>
        editor.link.subscribe((link) => {
          if (link === "lost") isLost = true;
          else if (link === "open" && isLost) resolve();
        }),
      );
      editor["connection"]["socket"]?.close();
      return isBack;
    });
    await this.harness.user.settle();
  }

  /** Expects the mark in the title and in the header, or neither. */
  async expectMark(isMarked: boolean): Promise<void> {
    const title = `^${isMarked ? "● " : ""}bar\\.(obj|json) – meshgraft$`; // an edit is loaded again by its own name
    await this.page.waitForFunction((title) => new RegExp(title).test(document.title), title);
    expect(await this.page.getByLabel("unsaved changes").count()).toBe(isMarked ? 1 : 0);
  }

  /** Loads the page again, and returns whether the browser asked before. */
  async reload(): Promise<boolean> {
    await this.page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name: "Handle", exact: true }).click(); // browsers ask only after a user's action
    this.asked.length = 0;
    await this.page.reload();
    await this.page.waitForFunction(() => window.meshgraft?.viewport.main !== undefined);
    await this.harness.user.settle();
    return this.asked.length > 0;
  }
}

test("the mark goes with undo and with saving, and comes with what differs from the saved state", async () => {
  const marked = await Marked.open();
  const { harness } = marked;
  try {
    await marked.expectMark(false);
    await marked.change("one");
    await marked.expectMark(true);
    await marked.press("Control+z");
    await marked.expectMark(false);
    await marked.press("Control+Shift+z");
    await marked.expectMark(true);
    await marked.page.evaluate((edit) => window.meshgraft.editor.ask({ do: "save", edit }), harness.folder.file("bar.json"));
    await marked.expectMark(false);
    await marked.press("Control+z");
    await marked.expectMark(true);
    await marked.press("Control+Shift+z");
    await marked.expectMark(false);
    expect(await marked.reload()).toBe(false);
    await marked.expectMark(false);
    expect(harness.user.complaints).toEqual([]);
  } finally {
    await harness.close();
  }
});

test("the mark is right after a lost connection and after the page was loaded again", async () => {
  const marked = await Marked.open();
  const { harness } = marked;
  try {
    await marked.loseConnection();
    await marked.expectMark(false);
    await marked.change("one");
    await marked.change("two");
    await marked.loseConnection();
    await marked.page.getByText("Reconnected.").waitFor();
    await marked.expectMark(true);
    for (let changes = 2; changes > 0; --changes) await marked.press("Control+z");
    await marked.expectMark(false);
    await marked.press("Control+Shift+z");
    await marked.expectMark(true);
    expect(await marked.reload()).toBe(true);
    await marked.page.getByText("The page was reloaded.").waitFor();
    await marked.expectMark(true);
    await marked.press("Control+z");
    await marked.expectMark(false);
    expect(await marked.reload()).toBe(false);
    await marked.expectMark(false);
    const isOfToken = (text: string) => text.includes("426"); // the page asked whether its token is still valid
    expect(harness.user.complaints.filter((text) => !isOfToken(text))).toEqual([]);
  } finally {
    await harness.close();
  }
});

test("the saved state is known after a lost connection and after the page was loaded again", async () => {
  const marked = await Marked.open();
  const { harness, page } = marked;
  const edit = harness.folder.file("bar.json");
  try {
    await marked.change("one");
    await page.evaluate((edit) => window.meshgraft.editor.ask({ do: "save", edit }), edit);
    await marked.change("two");
    await marked.loseConnection();
    await page.getByText("Reconnected.").waitFor();
    await marked.expectMark(true);
    await marked.press("Control+z");
    await marked.expectMark(false);
    await marked.press("Control+Shift+z");
    await marked.expectMark(true);
    expect(await marked.reload()).toBe(true);
    await page.getByText("The page was reloaded.").waitFor();
    await marked.press("Control+z");
    await marked.expectMark(false);
    await marked.press("Control+z");
    await marked.expectMark(true);
    await marked.press("Control+s"); // the engine knows the file, so it is written without a question
    await page.getByText("Saved", { exact: true }).waitFor();
    await marked.expectMark(false);
  } finally {
    await harness.close();
  }
});

test("a model that is loaded again before any change is open again", async () => {
  const marked = await Marked.open();
  try {
    expect(await marked.reload()).toBe(false);
    await marked.expectMark(false);
  } finally {
    await marked.harness.close();
  }
});
