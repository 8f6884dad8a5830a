import { handleColour as shownColour } from "../view/surface/roles";

/** Returns the colour of a handle by its index in the list, the same as in the view. */
export function handleColour(index: number): string {
  const [red, green, blue] = shownColour(index);
  return `rgb(${255 * red} ${255 * green} ${255 * blue})`;
}

// The hues differ from each other and from the handles' colours, in the light and the dark theme.
const hues = ["#3b8fd9", "#e8833a", "#4aa564", "#c75bb1", "#d9b02e", "#8a6fe0", "#d9534f", "#2fa7a5"] as const;

/** Returns a colour for the next group: the first unused hue, or the next in turn if all are used. */
export function groupColour(taken: readonly string[]): string {
  return hues.find((hue) => !taken.includes(hue)) ?? hues[taken.length % hues.length] ?? hues[0];
}
