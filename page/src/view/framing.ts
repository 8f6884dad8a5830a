import { Box3, Vector3, type Matrix4 } from "three";
import type { Surface } from "./surface/surface";

/** Returns some thousand points of each object, in world coordinates, 3 numbers each. */
export function samplePositions(shown: readonly (readonly [Pick<Surface, "sample">, Matrix4])[]): Float32Array {
  const samples = shown.map(([surface, matrix]) => transformed(surface.sample(), matrix));
  const all = new Float32Array(samples.reduce((sum, sample) => sum + sample.length, 0));
  samples.reduce((at, sample) => (all.set(sample, at), at + sample.length), 0);
  return all;
}

/** Returns whether points are inside a box of the page, except at most 1 % of them. */
export function areWithin(
  positions: Float32Array,
  box: DOMRect,
  project: (point: Vector3) => { x: number; y: number },
): boolean {
  const most = 0.01 * (positions.length / 3);
  const position = new Vector3();
  let beyond = 0;
  for (let at = 0; at < positions.length && beyond <= most; at += 3) {
    const { x, y } = project(position.fromArray(positions, at));
    if (x < box.left || x > box.right || y < box.top || y > box.bottom) ++beyond;
  }
  return beyond <= most;
}

/** Returns the centre of the box of points, 3 numbers each, and half its diagonal. */
export function aroundOf(positions: Float32Array): { centre: Vector3; radius: number } {
  const box = new Box3().setFromArray(positions);
  return { centre: box.getCenter(new Vector3()), radius: 0.5 * box.getSize(new Vector3()).length() };
}

function transformed(positions: Float32Array, map: Matrix4): Float32Array {
  const position = new Vector3();
  for (let at = 0; at + 2 < positions.length; at += 3)
    position.fromArray(positions, at).applyMatrix4(map).toArray(positions, at);
  return positions;
}
