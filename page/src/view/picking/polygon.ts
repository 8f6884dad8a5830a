/** A closed polygon of points in any unit. The last point is joined to the first. */
export type Polygon = readonly (readonly [number, number])[];

/** Tests whether points are inside a polygon (even–odd rule), fast for many points. */
export class PolygonTest {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
  private readonly xs: Float64Array;
  private readonly ys: Float64Array;

  constructor(polygon: Polygon) {
    this.xs = Float64Array.from(polygon, ([x]) => x);
    this.ys = Float64Array.from(polygon, ([, y]) => y);
    this.left = this.xs.reduce((a, b) => Math.min(a, b), Infinity);
    this.right = this.xs.reduce((a, b) => Math.max(a, b), -Infinity);
    this.top = this.ys.reduce((a, b) => Math.min(a, b), Infinity);
    this.bottom = this.ys.reduce((a, b) => Math.max(a, b), -Infinity);
  }

  contains(x: number, y: number): boolean {
    if (!(x >= this.left && x <= this.right && y >= this.top && y <= this.bottom)) return false;
    const { xs, ys } = this;
    let inside = false;
    for (let i = 0, j = xs.length - 1; i < xs.length; j = i++) {
      const yi = ys[i] as number;
      const yj = ys[j] as number;
      if (yi > y === yj > y) continue;
      const xi = xs[i] as number;
      if (x < xi + (((xs[j] as number) - xi) * (y - yi)) / (yj - yi)) inside = !inside;
    }
    return inside;
  }
}
