import type { Spot } from "./eye";

/** Spots along the pointer's way, close enough that a brush leaves no gaps, however fast it goes. */
export class DabPath {
  private last: Spot | undefined;

  constructor(
    private readonly start: Spot,
    private readonly spacing: number,
  ) {}

  /** The spots on the way to `spot` since the last one; the start where there was none. */
  to(spot: Spot): Spot[] {
    const spots: Spot[] = this.last === undefined ? [this.start] : [];
    const from = this.last ?? this.start;
    const length = Math.hypot(spot.x - from.x, spot.y - from.y);
    const steps = Math.floor(length / Math.max(1, this.spacing));
    for (let i = 1; i <= steps; ++i) {
      const t = (i * this.spacing) / length;
      spots.push({ x: from.x + t * (spot.x - from.x), y: from.y + t * (spot.y - from.y) });
    }
    this.last = spots[spots.length - 1] ?? this.last ?? this.start;
    return spots;
  }
}
