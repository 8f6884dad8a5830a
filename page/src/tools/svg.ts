import type { Spot } from "./eye";

type Value = string | number | undefined;

/** An element of the overlay. */
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

/** Sets attributes; undefined takes one away. */
export function set(element: Element, values: Record<string, Value>): void {
  for (const [name, value] of Object.entries(values))
    if (value === undefined) element.removeAttribute(name);
    else if (element.getAttribute(name) !== String(value)) element.setAttribute(name, String(value));
}

export function show(element: SVGElement, isShown: boolean): void {
  set(element, { display: isShown ? undefined : "none" });
}

/** The `d` of lines from spot to spot. */
export function linesThrough(spots: readonly Spot[], closed = false): string {
  const steps = spots.map(({ x, y }, i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`);
  return steps.join("") + (closed && spots.length > 0 ? "Z" : "");
}

/** Spots of the page as spots of the overlay. */
export function onOverlay(overlay: SVGSVGElement, spots: readonly Spot[]): Spot[] {
  const { left, top } = overlay.getBoundingClientRect();
  return spots.map(({ x, y }) => ({ x: x - left, y: y - top }));
}
