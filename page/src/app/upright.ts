/** A direction along an axis of the model's coordinates. */
export type Axis = "x" | "-x" | "y" | "-y" | "z" | "-z";
export const axes: readonly Axis[] = ["x", "-x", "y", "-y", "z", "-z"];

/** How a model stands: the directions of its upper side and of its front, at a right angle. */
export interface Upright {
  readonly up: Axis;
  readonly front: Axis;
}

export function opposite(axis: Axis): Axis {
  return (axis.startsWith("-") ? axis.slice(1) : `-${axis}`) as Axis;
}

export function vectorOf(axis: Axis): [number, number, number] {
  const sign = axis.startsWith("-") ? -1 : 1;
  const along = axis.slice(-1);
  return [along === "x" ? sign : 0, along === "y" ? sign : 0, along === "z" ? sign : 0];
}

/** Returns how a model stands that has this upper side. Without a front of its own it has the usual one: -y, or z where y is up. */
export function uprightOf(up: Axis, front?: Axis): Upright {
  if (front !== undefined && front.slice(-1) !== up.slice(-1)) return { up, front };
  return { up, front: up.slice(-1) === "y" ? "z" : "-y" };
}

/** Returns how a model stands after it was turned, by a right angle at most, so that a side of it is the front. */
export function withFront({ up, front }: Upright, side: Axis): Upright {
  if (side === up) return { up: opposite(front), front: side };
  if (side === opposite(up)) return { up: front, front: side };
  return { up, front: side };
}

/** The same for its upper side. */
export function withUp({ up, front }: Upright, side: Axis): Upright {
  if (side === front) return { up: side, front: opposite(up) };
  if (side === opposite(front)) return { up: side, front: up };
  return { up: side, front };
}
