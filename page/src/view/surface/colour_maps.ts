/** A colour map: colours with components from 0 to 1 at equal steps. */
export type ColourMap = readonly (readonly [number, number, number])[];

/** From blue for shrunk over pale grey for unchanged to red for grown. */
export const diverging: ColourMap = [
  [0.1, 0.25, 0.55],
  [0.27, 0.5, 0.76],
  [0.6, 0.77, 0.89],
  [0.91, 0.91, 0.9],
  [0.96, 0.72, 0.58],
  [0.85, 0.4, 0.31],
  [0.58, 0.09, 0.16],
];

/** From dark blue over green to light yellow; lighter is more. */
export const rising: ColourMap = [
  [0.14, 0.13, 0.36],
  [0.17, 0.31, 0.53],
  [0.12, 0.49, 0.55],
  [0.25, 0.66, 0.47],
  [0.6, 0.8, 0.33],
  [0.98, 0.93, 0.5],
];

/** Returns the colour of t, clamped to 0 … 1. */
export function colourAt(map: ColourMap, t: number): [number, number, number] {
  const position = Math.min(1, Math.max(0, Number.isFinite(t) ? t : 0)) * (map.length - 1);
  const i = Math.min(map.length - 2, Math.floor(position));
  const low = map[i] ?? [0, 0, 0];
  const high = map[i + 1] ?? low;
  const f = position - i;
  return [0, 1, 2].map((k) => (1 - f) * (low[k] as number) + f * (high[k] as number)) as [number, number, number];
}

/** Returns the RGBA bytes of a texture of `size` texels. */
export function colourTable(map: ColourMap, size: number): Uint8Array<ArrayBuffer> {
  const table = new Uint8Array(4 * size);
  for (let i = 0; i < size; ++i)
    table.set([...colourAt(map, i / (size - 1)).map((c) => Math.round(255 * c)), 255], 4 * i);
  return table;
}

/** Returns a CSS gradient from left to right, for a legend. */
export function cssGradient(map: ColourMap): string {
  return `linear-gradient(to right, ${map.map((c) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`).join(", ")})`;
}
