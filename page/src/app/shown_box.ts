import { signal, type ReadonlySignal } from "@preact/signals";
import type { Vector } from "../protocol";
import type { Box } from "./editor";

/** Returns the bounding box of positions, 3 numbers each, moved by `offset`; null without a finite position. */
export function boxOfPositions(positions: ArrayLike<number>, offset: Readonly<Vector>): Box | null {
  const low: Vector = [Infinity, Infinity, Infinity];
  const high: Vector = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const [x, y, z] = [positions[i] as number, positions[i + 1] as number, positions[i + 2] as number];
    if (!Number.isFinite(x + y + z)) continue;
    if (x < low[0]) low[0] = x;
    if (y < low[1]) low[1] = y;
    if (z < low[2]) low[2] = z;
    if (x > high[0]) high[0] = x;
    if (y > high[1]) high[1] = y;
    if (z > high[2]) high[2] = z;
  }
  if (low[0] > high[0]) return null;
  const moved = (at: Vector): Vector => [at[0] + offset[0], at[1] + offset[1], at[2] + offset[2]];
  return { low: moved(low), high: moved(high) };
}

interface ShownSurface {
  readonly positions: Float32Array;
  readonly offset: Readonly<Vector>;
  readonly version: number; // counts changes of `positions`
}
interface ShownIn {
  readonly main: ShownSurface | undefined;
  readonly onFrame: Set<() => void>;
}

const pauseMs = 100; // between two measurements, so that drags of large meshes stay fluent

/** Follows the bounding box of the model as it is shown, deformed. */
export function followShownBox(viewport: ShownIn): ReadonlySignal<Box | null> {
  const box = signal<Box | null>(null);
  let measured: ShownSurface | undefined;
  let version = -1;
  let waits = false;
  const measure = () => {
    waits = false;
    measured = viewport.main;
    version = measured?.version ?? -1;
    box.value = measured === undefined ? null : boxOfPositions(measured.positions, measured.offset);
  };
  viewport.onFrame.add(() => {
    const { main } = viewport;
    if (waits || (main === measured && (main?.version ?? -1) === version)) return;
    waits = true;
    setTimeout(measure, pauseMs);
  });
  return box;
}
