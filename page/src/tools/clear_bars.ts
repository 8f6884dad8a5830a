import type { ScreenPoint } from "./screen_camera";

/** A bar over the view, and the places where it may be. The first is where it usually is. */
interface Bar {
  readonly element: HTMLElement;
  readonly homes: readonly string[];
}

interface Rectangle {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

const clearancePx = 12; // between a grip's line and a bar

/** Returns how many points lie on rectangles, or nearer to them than a grip is wide. */
export function pointsUnder(points: readonly ScreenPoint[], rectangles: readonly Rectangle[]): number {
  const isUnder = ({ x, y }: ScreenPoint) =>
    rectangles.some(
      ({ left, right, top, bottom }) =>
        x > left - clearancePx && x < right + clearancePx && y > top - clearancePx && y < bottom + clearancePx,
    );
  return points.filter(isUnder).length;
}

/** Returns the home with the fewest points under the bar; of equals the first. */
export function bestHome(homes: readonly string[], pointsAt: (home: string) => number): string | undefined {
  let best: string | undefined;
  let least = Infinity;
  for (const home of homes) {
    const points = pointsAt(home);
    if (points < least) [best, least] = [home, points];
    if (least === 0) break;
  }
  return best;
}

/**
 * Keeps the bars over the view off the gizmo's grips. A bar names its homes in `data-homes`, and the style sheet places
 * it by `data-home`.
 */
export class ClearBars {
  constructor(private readonly area: () => HTMLElement | null) {}

  /** Returns a text that changes when bars come, go, or change their size. */
  get sizes(): string {
    return this.bars().map(({ element: { offsetWidth, offsetHeight } }) => `${offsetWidth}×${offsetHeight}`).join(" ");
  }

  /** Moves each bar back to where it usually is. */
  release(): void {
    for (const { element, homes } of this.bars()) put(element, homes[0] ?? "");
  }

  /** Moves each bar to a home where it covers none of the points, if there is one. */
  keepOff(points: readonly ScreenPoint[]): void {
    for (const bar of this.bars()) {
      const best = bestHome(bar.homes, (home) => {
        put(bar.element, home);
        return pointsUnder(points, rectanglesOf(bar.element));
      });
      put(bar.element, best ?? "");
    }
  }

  private bars(): Bar[] {
    const found = this.area()?.querySelectorAll<HTMLElement>("[data-homes]") ?? [];
    return [...found].map((element) => ({ element, homes: (element.dataset["homes"] ?? "").split(" ") }));
  }
}

/** Returns the rectangles that a bar covers: those of its lines if it has some, else its own. */
function rectanglesOf(bar: HTMLElement): Rectangle[] {
  const lines = [...bar.querySelectorAll(".tool-line, .toast")];
  return (lines.length > 0 ? lines : [bar]).map((one) => one.getBoundingClientRect()).filter(({ width }) => width > 0);
}

function put(element: HTMLElement, home: string): void {
  if (element.dataset["home"] !== home) element.dataset["home"] = home;
}
