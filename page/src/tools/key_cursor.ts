import type { ScreenPoint } from "./screen_camera";
import { onOverlay, set, show, svg } from "./svg";

/** What a key asks of the cursor. Steps are pixels of the page. */
export type CursorAction =
  | { readonly kind: "move"; readonly dx: number; readonly dy: number }
  | { readonly kind: "orbit"; readonly dx: number; readonly dy: number }
  | { readonly kind: "zoom"; readonly factor: number }
  | { readonly kind: "press" };

const stepPx = 12;
const longStepPx = 48;
const shortStepPx = 2;
const directions: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
};

/** Returns what a key asks for while the view has the focus; undefined if it is no key of the cursor. */
export function cursorAction(press: Pick<KeyboardEvent, "key" | "shiftKey" | "altKey" | "ctrlKey" | "metaKey">): CursorAction | undefined {
  const { key, shiftKey, altKey } = press;
  const isCtrl = press.ctrlKey || press.metaKey;
  const [dx, dy] = directions[key] ?? [0, 0];
  if (dx !== 0 || dy !== 0) {
    const step = shiftKey ? longStepPx : altKey ? shortStepPx : stepPx;
    return { kind: isCtrl ? "orbit" : "move", dx: step * dx, dy: step * dy };
  }
  if (isCtrl || altKey) return undefined;
  if (key === "PageUp" || key === "PageDown") return { kind: "zoom", factor: key === "PageUp" ? 1 / 1.2 : 1.2 };
  return key === " " ? { kind: "press" } : undefined;
}

/** A cross over the view that the arrow keys move, for picking and painting without a pointer. */
export class KeyCursor {
  private readonly element = svg(
    "g",
    { class: "key-cursor", display: "none" },
    svg("path", { class: "halo", d: "M-14 0H-4M4 0H14M0 -14V-4M0 4V14" }),
    svg("path", { d: "M-14 0H-4M4 0H14M0 -14V-4M0 4V14" }),
  );
  private at: ScreenPoint | undefined;

  constructor(private readonly overlay: SVGSVGElement) {
    overlay.append(this.element);
  }

  /** Where it is; undefined while it is hidden. */
  get position(): ScreenPoint | undefined {
    return this.at;
  }

  /** Moves it within the view. If it was hidden, it appears at `start`, or in the middle if that is out of the view. */
  move(dx: number, dy: number, start: ScreenPoint): ScreenPoint {
    const { left, right, top, bottom } = this.overlay.getBoundingClientRect();
    const isInView = start.x > left && start.x < right && start.y > top && start.y < bottom;
    const from = this.at ?? (isInView ? start : { x: (left + right) / 2, y: (top + bottom) / 2 });
    this.at = { x: Math.min(right - 1, Math.max(left + 1, from.x + dx)), y: Math.min(bottom - 1, Math.max(top + 1, from.y + dy)) };
    const [{ x, y }] = onOverlay(this.overlay, [this.at]) as [ScreenPoint];
    set(this.element, { transform: `translate(${x} ${y})` });
    if (this.overlay.lastElementChild !== this.element) this.overlay.append(this.element);
    show(this.element, true);
    return this.at;
  }

  hide(): void {
    this.at = undefined;
    show(this.element, false);
  }
}
