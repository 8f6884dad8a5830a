// Hues that are told apart in light and dark, also by most people who see fewer colours.
const hues = ["#e8833a", "#3b8fd9", "#c75bb1", "#4aa564", "#d9b02e", "#8a6fe0", "#d9534f", "#2fa7a5"] as const;

/** The colour of a handle, by its place in the list. */
export function handleColour(index: number): string {
  return hues[index % hues.length] ?? hues[0];
}

/** A colour for the next group. */
export function groupColour(taken: readonly string[]): string {
  return hues.find((hue) => !taken.includes(hue)) ?? handleColour(taken.length);
}
