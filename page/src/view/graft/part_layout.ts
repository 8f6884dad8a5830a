// Computes where parts are placed beside the model while they are apart. No state, no screen.

type Vector = readonly [number, number, number];

/** An axis-aligned box: the least and the largest coordinates. */
export interface Box {
  readonly min: Vector;
  readonly max: Vector;
}

/** A part and the unit direction from the model in which it is placed. */
export interface PartBox extends Box {
  readonly towards: Vector;
}

/** x' = scale x + offset: from an object's own coordinates to where it is shown. */
export interface PartTransform {
  readonly scale: number;
  readonly offset: Vector;
}

const comparable = 4; // a part that is more times larger or smaller than the model is shown scaled to the model's size

/**
 * Places parts beside the model, each in its direction, with the centres at the height of the model's centre. A part is
 * placed beyond all earlier ones in its direction, so that none overlap. If that direction is the camera's right, none
 * hide each other. Parts of a very different size are scaled to the model's.
 */
export function layOutParts(model: Box, parts: readonly PartBox[]): PartTransform[] {
  const size = diagonal(model);
  const gap = 0.12 * size;
  const placed: Box[] = [model];
  return parts.map((part) => {
    const own = diagonal(part);
    const alike = own > 0 && size > 0 && own <= comparable * size && size <= comparable * own;
    const scale = alike || own === 0 || size === 0 ? 1 : size / own;
    const { towards } = part;
    const farthest = Math.max(...placed.map((box) => dot(centreOf(box), towards) + extentAlong(box, towards)));
    const distance = farthest + gap + scale * extentAlong(part, towards) - dot(centreOf(model), towards);
    const offset = add(add(centreOf(model), towards, distance), centreOf(part), -scale);
    placed.push({ min: add(offset, part.min, scale), max: add(offset, part.max, scale) });
    return { scale, offset };
  });
}

export function diagonal({ min, max }: Box): number {
  return Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
}

/** Returns the extent of a box from its centre in a direction. */
function extentAlong({ min, max }: Box, [x, y, z]: Vector): number {
  return (Math.abs(x) * (max[0] - min[0]) + Math.abs(y) * (max[1] - min[1]) + Math.abs(z) * (max[2] - min[2])) / 2;
}

function centreOf({ min, max }: Box): Vector {
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
}

function add(to: Vector, what: Vector, times: number): Vector {
  return [to[0] + times * what[0], to[1] + times * what[1], to[2] + times * what[2]];
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
