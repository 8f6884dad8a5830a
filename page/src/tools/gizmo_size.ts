import { viewRingPx } from "./gizmo_layout";
import type { ScreenPoint } from "./screen_camera";

/** What the size of the gizmo depends on. Lengths are CSS pixels. */
export interface GizmoRoom {
  /** Radius of what it moves, on the screen; undefined if it has none. */
  readonly movedPx: number | undefined;
  readonly viewWidth: number;
  readonly viewHeight: number;
  /** Whether fingers take the grips. */
  readonly isCoarse: boolean;
}

const least = 0.72; // grips that are nearer to each other cannot be told apart
const leastCoarse = 1;
const marginPx = 16;

/**
 * Returns the size of the gizmo, × its usual size: its outer ring fits around what it moves, its grips stay apart, and
 * it fits the view.
 */
export function gizmoScale({ movedPx, viewWidth, viewHeight, isCoarse }: GizmoRoom): number {
  const smallest = isCoarse ? leastCoarse : least;
  const fitting = movedPx === undefined ? 1 : (1.2 * movedPx) / viewRingPx;
  const largest = Math.min(1, (Math.min(viewWidth, viewHeight) / 2 - marginPx) / viewRingPx);
  return Math.max(least, Math.min(largest, Math.max(smallest, fitting)));
}

interface Box {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

/**
 * Returns how far the gizmo is drawn from its centre, so that all of it is in the view. It stays at a centre out of the
 * view.
 */
export function gizmoShift(centre: ScreenPoint, scale: number, view: Box): ScreenPoint {
  const { x, y } = centre;
  const isInView = x >= view.left && x <= view.right && y >= view.top && y <= view.bottom;
  const radius = scale * viewRingPx + marginPx;
  if (!isInView) return { x: 0, y: 0 };
  return { x: within(x, view.left + radius, view.right - radius) - x, y: within(y, view.top + radius, view.bottom - radius) - y };
}

/** Returns the number nearest to `value` from `low` to `high`, or their mean where they are the other way round. */
function within(value: number, low: number, high: number): number {
  return low > high ? (low + high) / 2 : Math.min(high, Math.max(low, value));
}
