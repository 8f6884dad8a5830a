import type { User } from "./harness";

/** Presses tab until an element of this name has the focus. */
export async function tabTo(user: User, name: RegExp, most = 60): Promise<void> {
  for (let i = 0; i < most; ++i) {
    const label = await user.page.evaluate(() => {
      const element = document.activeElement;
      if (!(element instanceof HTMLElement)) return "";
      const named = element.getAttribute("aria-labelledby");
      const labels = "labels" in element ? (element as HTMLInputElement).labels : null;
      return (
        element.getAttribute("aria-label") ??
        (named === null ? null : document.getElementById(named)?.textContent) ??
        labels?.[0]?.textContent ??
        element.textContent ??
        ""
      );
    });
    if (name.test(label)) return;
    await user.page.keyboard.press("Tab");
  }
  throw new Error(`tab does not come to ${name}`);
}
