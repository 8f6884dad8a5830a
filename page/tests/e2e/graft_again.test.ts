import { afterEach, expect, test } from "vitest";
import { close, grafted, graftOf, openWithPart } from "./grafting";
import type { User } from "./harness";

afterEach(close);

const stepsOf = (user: User) => user.page.evaluate(() => window.meshgraft.editor.state.value?.steps ?? []);

async function openSteps(user: User): Promise<void> {
  await user.page.getByRole("tab", { name: "Deform" }).click();
  if ((await user.page.getByRole("list", { name: "Steps" }).count()) === 0) await user.page.getByText("Steps", { exact: true }).click();
}

/** A head on a bust, cut by a plane, with the shape of its crown changed. */
async function withLaterSteps(): Promise<User> {
  const { user } = await openWithPart("bust", "head", 24, true);
  const { page } = user;
  await grafted(user);
  await user.press("Control+Enter");
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const { low, high } = editor.box.value!;
    const below = low[2] + 0.1 * (high[2] - low[2]);
    await editor.ask({ do: "cut", plane: { point: [0, 0, below], normal: [0, 0, 1] }, keep: "above" });
    await editor.ask({ do: "sculpt", action: "inflate", height: 0.01, select: { indices: [0, 1, 2, 3] } });
  });
  return user;
}

test("an earlier graft is edited again with the later steps set aside, and they follow it", async () => {
  const user = await withLaterSteps();
  const { page } = user;
  const before = await stepsOf(user);
  const toolOf = (name: string) => page.getByRole("toolbar", { name: "Tools" }).getByRole("button", { name, exact: true });
  await page.getByRole("tab", { name: "Deform" }).click();
  await toolOf("Handle").click();
  await openSteps(user);
  await page.getByText("1. Graft: head on bust").click();
  await user.click("Edit pairs and placement…");
  await grafted(user);
  await openSteps(user);
  expect(await page.locator(".steps .set-aside").allInnerTexts()).toEqual([
    expect.stringContaining("2. Cut: bust"),
    expect.stringContaining("3. Shape: bust"),
  ]);
  for (const name of ["Handle", "Lay flat"]) expect(await toolOf(name).isDisabled()).toBe(true);
  expect(await toolOf("Navigate").getAttribute("aria-pressed")).toBe("true");
  await user.press("a"); // selects all, which nothing may be made of
  expect(await page.getByRole("button", { name: "Make handle" }).isDisabled()).toBe(true);
  await user.rests();
  await user.screenshot("steps-set-aside");
  await user.click("Show the graft");
  await page.getByText(/^2 later steps are set aside/).waitFor();
  await page.getByText("Manual", { exact: true }).click();
  await grafted(user);
  await user.rests();
  await user.screenshot("graft-earlier-again");
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  const after = await stepsOf(user);
  expect(after.map(({ kind }) => kind)).toEqual(before.map(({ kind }) => kind));
  expect(after[0]?.fields).toMatchObject({ pose: "keep" });
  expect(after[1]?.fields).toEqual(before[1]?.fields);
  await user.rests();
  await user.screenshot("graft-earlier-accepted");
  expect(user.complaints).toEqual([]);
}, 180_000);

test("a later step that no longer applies is named, and Cancel brings everything back", async () => {
  const user = await withLaterSteps();
  const { page } = user;
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    const { low, high } = editor.box.value!;
    const above = high[2] - 0.1 * (high[2] - low[2]);
    await editor.ask({ do: "step", what: "change", index: 1, fields: { plane: { point: [0, 0, above], normal: [0, 0, 1] } } });
  });
  const before = await stepsOf(user);
  await openSteps(user);
  await page.getByText("1. Graft: head on bust").click();
  await user.click("Edit pairs and placement…");
  await grafted(user);
  await page.evaluate(async () => void (await window.meshgraft.editor.graft.set({ size: 0.05 })));
  await grafted(user);
  await page.locator(".graft-end").getByRole("button", { name: "Accept" }).click();
  await page.getByText(/“2\. Cut: bust” no longer applies to the edited graft/).waitFor();
  expect(await graftOf(user)).not.toBeNull();
  await user.rests();
  await user.screenshot("graft-earlier-refused");
  await page.locator(".graft-end").getByRole("button", { name: "Cancel" }).click();
  await page.waitForFunction(() => window.meshgraft.editor.state.value?.graft === null);
  expect(await stepsOf(user)).toEqual(before);
}, 180_000);
