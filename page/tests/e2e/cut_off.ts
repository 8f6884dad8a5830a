import type { User } from "./harness";

/**
 * Returns the labels of what can be pressed or typed in, and reaches out of the window, of the bar that holds it, or of
 * anything that hides what is beyond it. Where one can scroll up and down, nothing is cut off there.
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
          if (one.matches(".segments label, .row > label") && one.scrollWidth > one.clientWidth + 1) return true;
          const { left, right } = one.getBoundingClientRect();
          for (let outer: Element | null = one.parentElement; outer !== null; outer = outer.parentElement) {
            if (outer !== bar && !hides(outer)) continue;
            const box = outer.getBoundingClientRect();
            if (left < box.left - 1 || right > Math.min(box.right, innerWidth) + 1) return true;
          }
          const { top, bottom } = one.getBoundingClientRect();
          for (let outer: Element | null = one.parentElement; outer !== null; outer = outer.parentElement) {
            const { overflowY } = getComputedStyle(outer);
            if (overflowY === "auto" || overflowY === "scroll") return false;
            const box = outer.getBoundingClientRect();
            if (overflowY !== "visible" && (top < box.top - 1 || bottom > box.bottom + 1)) return true;
          }
          return top < -1 || bottom > innerHeight + 1;
        })
        .map(said),
    );
  }, bars);
}
