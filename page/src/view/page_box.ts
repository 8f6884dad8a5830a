const measured = new WeakMap<Element, DOMRect>();

/**
 * Returns an element's box on the page. It is measured once per task of the browser, because each measurement after a
 * change of the page lays the page out.
 */
export function pageBox(element: Element): DOMRect {
  const known = measured.get(element);
  if (known !== undefined) return known;
  const box = element.getBoundingClientRect();
  measured.set(element, box);
  queueMicrotask(() => measured.delete(element));
  return box;
}
