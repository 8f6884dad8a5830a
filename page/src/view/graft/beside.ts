// Where parts stand beside the model while they are apart. No state, no screen.

type Vector = readonly [number, number, number];

/** An axis-parallel box: the least and the largest coordinates. */
export interface Box {
  readonly min: Vector;
  readonly max: Vector;
}

/** A part, and the direction (of length 1) in which it stands as seen from the model. */
export interface Beside extends Box {
  readonly towards: Vector;
}

/** x' = scale x + offset: of how an object is shown, no matter where it is. */
export interface Standing {
  readonly scale: number;
  readonly offset: Vector;
}

const comparable = 4; // a part that is so many times larger or smaller than the model is shown in its size

/**
 * Places for parts beside the model, each in its direction, with its middle at the height of the model's. A part lies
 * beyond all before it in its direction, so that no two overlap, nor hide each other where that is the camera's right.
 * Parts whose size has nothing to do with the model's are scaled to it.
 */
export function standBeside(model: Box, parts: readonly Beside[]): Standing[] {
  const size = diagonal(model);
  const gap = 0.12 * size;
  const placed: Box[] = [model];
  return parts.map((part) => {
    const own = diagonal(part);
    const alike = own > 0 && size > 0 && own <= comparable * size && size <= comparable * own;
    const scale = alike || own === 0 || size === 0 ? 1 : size / own;
    const { towards } = part;
    const farthest = Math.max(...placed.map((box) => dot(middle(box), towards) + reach(box, towards)));
    const far = farthest + gap + scale * reach(part, towards) - dot(middle(model), towards);
    const offset = add(add(middle(model), towards, far), middle(part), -scale);
    placed.push({ min: add(offset, part.min, scale), max: add(offset, part.max, scale) });
    return { scale, offset };
  });
}

export function diagonal({ min, max }: Box): number {
  return Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
}

/** How far a box goes from its middle in a direction. */
function reach({ min, max }: Box, [x, y, z]: Vector): number {
  return (Math.abs(x) * (max[0] - min[0]) + Math.abs(y) * (max[1] - min[1]) + Math.abs(z) * (max[2] - min[2])) / 2;
}

function middle({ min, max }: Box): Vector {
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
}

function add(to: Vector, what: Vector, times: number): Vector {
  return [to[0] + times * what[0], to[1] + times * what[1], to[2] + times * what[2]];
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
