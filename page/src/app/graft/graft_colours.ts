/** Colours used by grafts, components from 0 to 1. Pairs of loops take theirs in order. */
export const partColour = [0.47, 0.6, 0.82] as const;
export const seamColour = [0.95, 0.55, 0.15] as const;
export const loopColour = [0.16, 0.42, 0.86] as const;
export const pickedColour = [0.98, 0.8, 0.1] as const;
const pairColours = [
  [0.89, 0.25, 0.3],
  [0.1, 0.62, 0.42],
  [0.56, 0.34, 0.86],
  [0.9, 0.55, 0.05],
  [0.05, 0.6, 0.75],
  [0.82, 0.3, 0.65],
  [0.45, 0.6, 0.12],
  [0.55, 0.42, 0.28],
] as const;

export type Colour = readonly [number, number, number];

export function pairColour(index: number): Colour {
  return pairColours[index % pairColours.length] ?? pairColours[0];
}

/** Formats a colour for CSS. */
export function cssColour([r, g, b]: Colour): string {
  return `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;
}
