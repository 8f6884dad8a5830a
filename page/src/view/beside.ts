// Where parts stand beside the model while they are apart. No state, no screen.

/** An axis-parallel box: the least and the largest coordinates. */
export interface Box {
  readonly min: readonly [number, number, number];
  readonly max: readonly [number, number, number];
}

/** x' = scale x + offset: of how an object is shown, no matter where it is. */
export interface Standing {
  readonly scale: number;
  readonly offset: readonly [number, number, number];
}

const comparable = 4; // a part that is so many times larger or smaller than the model is shown in its size

/**
 * Places for parts beside the model, in a row along x from its right-hand side on, at the height of its middle. No two
 * boxes overlap. Parts whose size has nothing to do with the model's are scaled to it.
 */
export function standBeside(model: Box, parts: readonly Box[]): Standing[] {
  const size = diagonal(model);
  const gap = 0.12 * size;
  let right = model.max[0];
  return parts.map((part) => {
    const own = diagonal(part);
    const alike = own > 0 && size > 0 && own <= comparable * size && size <= comparable * own;
    const scale = alike || own === 0 || size === 0 ? 1 : size / own;
    const left = right + gap;
    right = left + scale * (part.max[0] - part.min[0]);
    const level = (k: 1 | 2) => middle(model, k) - scale * middle(part, k);
    return { scale, offset: [left - scale * part.min[0], level(1), level(2)] };
  });
}

export function diagonal({ min, max }: Box): number {
  return Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
}

function middle({ min, max }: Box, k: 0 | 1 | 2): number {
  return (min[k] + max[k]) / 2;
}
