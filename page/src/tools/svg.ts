import { pageBox } from "../view/page_box";
import type { ScreenPoint } from "./screen_camera";

type Value = string | number | undefined;

/** Makes an SVG element for the overlay. */
export function svg<Name extends keyof SVGElementTagNameMap>(
  name: Name,
  values: Record<string, Value> = {},
  ...children: SVGElement[]
): SVGElementTagNameMap[Name] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  set(element, values);
  element.append(...children);
  return element;
}

/** Sets attributes; undefined removes one. */
export function set(element: Element, values: Record<string, Value>): void {
  for (const [name, value] of Object.entries(values))
    if (value === undefined) element.removeAttribute(name);
    else if (element.getAttribute(name) !== String(value)) element.setAttribute(name, String(value));
}

export function show(element: SVGElement, isShown: boolean): void {
  set(element, { display: isShown ? undefined : "none" });
}

/** Returns the `d` attribute of a polyline through screen points. */
export function linesThrough(screenPoints: readonly ScreenPoint[], closed = false): string {
  const steps = screenPoints.map(({ x, y }, i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`);
  return steps.join("") + (closed && screenPoints.length > 0 ? "Z" : "");
}

/** Converts points of the page to points of the overlay. */
export function onOverlay(overlay: SVGSVGElement, screenPoints: readonly ScreenPoint[]): ScreenPoint[] {
  const { left, top } = pageBox(overlay);
  return screenPoints.map(({ x, y }) => ({ x: x - left, y: y - top }));
}
