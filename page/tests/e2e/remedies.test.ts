// Buttons that do what a message asks for, or lead there.
import { afterEach, expect, test } from "vitest";
import { EditorHarness } from "./harness";

let harness: EditorHarness | undefined;
afterEach(async () => {
  await harness?.close();
  harness = undefined;
});

/** Returns the name of the control that has the focus. */
const focused = () =>
  harness!.user.page.evaluate(() => {
    const one = document.activeElement;
    const label = document.getElementById(one?.getAttribute("aria-labelledby") ?? "");
    return label?.textContent ?? one?.textContent ?? "";
  });

test("a refusal leads to the folded field that it names", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bar", 12);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.setSymmetry(true);
    const select = { box: { min: [-0.25, -9, 3], max: [9, 9, 9] } } as never;
    await editor.ask({ do: "handle", what: "add", name: "top", select, reach: 3 });
  });
  await page.getByRole("alert").getByText("overlaps its mirror image").waitFor();
  await page.getByRole("tab", { name: "Graft" }).click();
  await user.click("Show Offset");
  await expect.poll(focused).toBe("Offset");
  expect(await page.locator(".pointed-at").isVisible()).toBe(true);
  await user.screenshot("remedy-offset");
  expect(user.complaints).toEqual([]);
});

test("a refusal while a graft is edited leads to the graft", async () => {
  harness = await EditorHarness.open();
  const { user } = harness;
  const { page } = user;
  await harness.openSample("bust", 30);
  await page.evaluate(async () => {
    const { editor } = window.meshgraft;
    await editor.graft.addPart({ sample: "head", resolution: 30 });
    editor.graft.mode.value = "deform";
    await editor.ask({ do: "repair", mesh: editor.state.value!.model.name });
  });
  await page.getByRole("alert").getByRole("button", { name: "Show the graft" }).click();
  await expect.poll(focused).toMatch(/^Accept/);
  expect(await page.evaluate(() => window.meshgraft.editor.graft.mode.value)).toBe("graft");
  expect(user.complaints).toEqual([]);
});
