import { Vector3, type Matrix4 } from "three";
import type { Surface } from "./surface/surface";

/** Returns some thousand points of each surface, in world coordinates, 3 numbers each. */
export function placesOf(shown: readonly (readonly [Surface, Matrix4])[]): Float32Array {
  const samples = shown.map(([surface, stand]) => moved(surface.sample(), stand));
  const all = new Float32Array(samples.reduce((sum, sample) => sum + sample.length, 0));
  samples.reduce((at, sample) => (all.set(sample, at), at + sample.length), 0);
  return all;
}

/** Returns whether points are inside a box of the page, except at most 1 % of them. */
export function areWithin(places: Float32Array, box: DOMRect, project: (point: Vector3) => { x: number; y: number }): boolean {
  const most = 0.01 * (places.length / 3);
  const place = new Vector3();
  let beyond = 0;
  for (let at = 0; at < places.length && beyond <= most; at += 3) {
    const { x, y } = project(place.fromArray(places, at));
    if (x < box.left || x > box.right || y < box.top || y > box.bottom) ++beyond;
  }
  return beyond <= most;
}

function moved(places: Float32Array, map: Matrix4): Float32Array {
  const place = new Vector3();
  for (let at = 0; at + 2 < places.length; at += 3) place.fromArray(places, at).applyMatrix4(map).toArray(places, at);
  return places;
}
