import type { Outcome } from "../engine/connection";
import { noteWords } from "./wording";

interface Selected {
  /** 255 where a vertex is selected. */
  readonly selection: Uint8Array;
  readonly positions: Float32Array;
}

const highest = 0.25; // × the size of what is selected

/** Returns the height, in model units, to which the selected part of a surface is inflated by a strength up to 1. */
export function inflatedHeight({ selection, positions }: Selected, strength: number): number {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  selection.forEach((is, v) => {
    if (is === 0) return;
    for (let k = 0; k < 3; ++k) {
      const at = positions[3 * v + k] as number;
      low[k] = Math.min(low[k] as number, at);
      high[k] = Math.max(high[k] as number, at);
    }
  });
  const size = Math.hypot(...high.map((most, k) => most - (low[k] as number)));
  return Number.isFinite(size) ? highest * strength * size : 0;
}

/** Returns what to tell the user of a shaped region; undefined if all went as asked. */
export function shapedWords({ notes = [] }: Outcome): string | undefined {
  return notes.length === 0 ? undefined : notes.map(noteWords).join(" ");
}
