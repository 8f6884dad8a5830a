import { handleColour as shownColour } from "../view/surface/roles";

/** The colour of a handle by its place in the list, as the view shows it. */
export function handleColour(index: number): string {
  const [red, green, blue] = shownColour(index);
  return `rgb(${255 * red} ${255 * green} ${255 * blue})`;
}

// Told apart in light and dark, and from the handles.
const hues = ["#3b8fd9", "#e8833a", "#4aa564", "#c75bb1", "#d9b02e", "#8a6fe0", "#d9534f", "#2fa7a5"] as const;

/** A colour for the next group: one that is free, else the next in turn. */
export function groupColour(taken: readonly string[]): string {
  return hues.find((hue) => !taken.includes(hue)) ?? hues[taken.length % hues.length] ?? hues[0];
}
