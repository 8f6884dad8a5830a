import type { ScreenPoint } from "./screen_camera";

/** Points along the pointer's path, spaced closely enough that a fast brush leaves no gaps. */
export class StrokePath {
  private last: ScreenPoint | undefined;

  constructor(private readonly start: ScreenPoint) {}

  /**
   * Returns the points on the way to `screenPoint` since the last one, at most `spacing` pixels apart, beginning with the
   * start on the first call.
   */
  to(screenPoint: ScreenPoint, spacing: number): ScreenPoint[] {
    const screenPoints: ScreenPoint[] = this.last === undefined ? [this.start] : [];
    const from = this.last ?? this.start;
    const length = Math.hypot(screenPoint.x - from.x, screenPoint.y - from.y);
    const step = Math.max(1, spacing);
    const steps = Math.floor(length / step);
    for (let i = 1; i <= steps; ++i) {
      const t = (i * step) / length;
      screenPoints.push({ x: from.x + t * (screenPoint.x - from.x), y: from.y + t * (screenPoint.y - from.y) });
    }
    this.last = screenPoints[screenPoints.length - 1] ?? this.last ?? this.start;
    return screenPoints;
  }
}
