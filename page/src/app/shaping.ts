import type { Outcome } from "../engine/connection";
import { noteWords } from "./wording";

interface Selected {
  /** 255 where a vertex is selected. */
  readonly selection: Uint8Array;
  readonly positions: Float32Array;
}

const highest = 0.25; // × the size of what is selected
const leastSize = 0.02; // × the size of the surface: that of a single vertex

/** Returns the height, in model units, to which the selected part of a surface is inflated by a strength up to 1. */
export function inflatedHeight({ selection, positions }: Selected, strength: number): number {
  const size = sizeOf(positions, (v) => selection[v] !== 0);
  if (size === undefined) return 0;
  return highest * strength * Math.max(size, leastSize * (sizeOf(positions, () => true) ?? 0));
}

/** Returns the reach that *Fade: Around* begins with, model units. */
export function usualReach(diagonal: number): number {
  return Number((0.05 * diagonal).toPrecision(2));
}

/** Returns the diagonal of the box around these vertices; undefined if there are none. */
function sizeOf(positions: Float32Array, includes: (vertex: number) => boolean): number | undefined {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let v = 0; 3 * v < positions.length; ++v) {
    if (!includes(v)) continue;
    for (let k = 0; k < 3; ++k) {
      const at = positions[3 * v + k] as number;
      low[k] = Math.min(low[k] as number, at);
      high[k] = Math.max(high[k] as number, at);
    }
  }
  const size = Math.hypot(...high.map((most, k) => most - (low[k] as number)));
  return Number.isFinite(size) ? size : undefined;
}

/** Returns what to tell the user of a shaped region; undefined if all went as asked. */
export function shapedWords({ notes = [] }: Outcome): string | undefined {
  return notes.length === 0 ? undefined : notes.map(noteWords).join(" ");
}
