import type { User } from "./harness";

/**
 * Returns the labels of what can be pressed or typed in, and reaches out of the window, of the bar that holds it, or of
 * anything between that hides what is beyond it.
 */
export function cutOff(user: User, bars: string): Promise<string[]> {
  return user.page.evaluate((bars) => {
    const said = (one: Element) => one.getAttribute("aria-label") ?? one.textContent ?? "?";
    const hides = (one: Element) => getComputedStyle(one).overflowX !== "visible";
    const pressed = "button, select, label, input:not(.segments input), .tool-hint";
    return [...document.querySelectorAll(bars)].flatMap((bar) =>
      [...bar.querySelectorAll(pressed)]
        .filter((one) => one.getClientRects().length > 0)
        .filter((one) => {
          const { left, right } = one.getBoundingClientRect();
          for (let outer: Element | null = one.parentElement; outer !== null; outer = outer.parentElement) {
            if (outer !== bar && !hides(outer)) continue;
            const box = outer.getBoundingClientRect();
            if (left < box.left - 1 || right > Math.min(box.right, innerWidth) + 1) return true;
            if (outer === bar) break;
          }
          return false;
        })
        .map(said),
    );
  }, bars);
}
