import type { ScreenPoint } from "./screen_camera";
import { onOverlay, set, show, svg } from "./svg";

/** A line of text beside the pointer that describes a gesture or what a click would take. */
export class Status {
  private readonly text = svg("text", { x: 9, y: 17 });
  private readonly back = svg("rect", { rx: 6, height: 25 });
  private readonly element = svg("g", { class: "tool-status", display: "none" }, this.back, this.text);

  private measured = { shape: "", width: 18 };

  constructor(private readonly overlay: SVGSVGElement) {
    overlay.append(this.element);
  }

  say(words: string, { x, y }: ScreenPoint): void {
    overlayLast(this.overlay, this.element);
    show(this.element, true);
    if (this.text.textContent !== words) this.text.textContent = words;
    const width = this.widthOf(words);
    set(this.back, { width });
    const [at] = onOverlay(this.overlay, [{ x: x + 22, y: y + 22 }]) as [ScreenPoint];
    const left = Math.max(4, Math.min(at.x, this.overlay.clientWidth - width - 4));
    const top = Math.max(4, Math.min(at.y, this.overlay.clientHeight - 30));
    set(this.element, { transform: `translate(${left} ${top})` });
  }

  // All digits are as wide (tabular-nums), so that numbers which count up are not measured each time.
  private widthOf(words: string): number {
    const shape = words.replace(/\d/g, "0");
    if (shape !== this.measured.shape) this.measured = { shape, width: this.text.getComputedTextLength() + 18 };
    return this.measured.width;
  }

  /** What it says now; empty if nothing. */
  get words(): string {
    return this.element.hasAttribute("display") ? "" : (this.text.textContent ?? "");
  }

  clear(): void {
    show(this.element, false);
  }
}

function overlayLast(overlay: SVGSVGElement, element: SVGElement): void {
  if (overlay.lastElementChild !== element) overlay.append(element);
}
