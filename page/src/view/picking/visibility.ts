import { Vector3, type Ray } from "three";
import type { PickTree } from "./pick_tree";
import type { Surface } from "../surface/surface";

const mostRays = 20_000; // for single vertices; for more of them a depth grid is used

/** The view's projection of points: the ray to a point, its depth and its pixel on the page. */
export interface ScreenProjector {
  /** Writes the vector from a point towards the camera to `out`. Its length is not 1. */
  towardsCamera(position: Vector3, out: Vector3): Vector3;
  depthOf(position: Vector3): number;
  pixelOf(position: Vector3): { x: number; y: number };
  rayAt(x: number, y: number): Ray;
}

/** Returns those of `vertices` that face the camera and are not hidden by the surface. */
export function visibleVertices(
  surface: Surface,
  vertices: Uint32Array,
  tree: PickTree,
  projector: ScreenProjector,
): Uint32Array {
  const front = facing(surface, vertices, projector);
  if (!tree.prepare()) return front;
  if (front.length <= mostRays) return front.filter((v) => !isHidden(surface, v, tree, projector));
  const depths = new DepthGrid(surface, front, tree, projector);
  const position = new Vector3();
  return front.filter((v) => depths.shows(surface.positionOf(v, position)));
}

function facing(surface: Surface, vertices: Uint32Array, projector: ScreenProjector): Uint32Array {
  const n = surface.normals;
  const position = new Vector3();
  const towards = new Vector3();
  return vertices.filter((v) => {
    projector.towardsCamera(surface.positionOf(v, position), towards);
    const along = (n[3 * v] as number) * towards.x + (n[3 * v + 1] as number) * towards.y;
    return along + (n[3 * v + 2] as number) * towards.z > 0;
  });
}

function isHidden(surface: Surface, v: number, tree: PickTree, projector: ScreenProjector): boolean {
  const position = surface.positionOf(v);
  const towards = projector.towardsCamera(position, new Vector3()).normalize();
  const start = position.sub(surface.object.position).addScaledVector(towards, 3e-4 * surface.box.diagonal);
  return tree.raycast(start, towards) !== undefined;
}

/** Depths of the surface on a grid of some pixels around the given vertices, one ray for each grid point. */
class DepthGrid {
  private readonly left: number;
  private readonly top: number;
  private readonly columns: number;
  private readonly rows: number;
  private readonly step: number;
  private readonly depths: Float32Array;
  private readonly slack: number;

  constructor(
    surface: Surface,
    vertices: Uint32Array,
    tree: PickTree,
    private readonly projector: ScreenProjector,
  ) {
    let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
    const position = new Vector3();
    for (const v of vertices) {
      const { x, y } = projector.pixelOf(surface.positionOf(v, position));
      left = Math.min(left, x);
      right = Math.max(right, x);
      top = Math.min(top, y);
      bottom = Math.max(bottom, y);
    }
    this.step = Math.max(1.5, Math.sqrt(((right - left) * (bottom - top)) / mostRays));
    this.left = left - this.step;
    this.top = top - this.step;
    this.columns = Math.ceil((right - left) / this.step) + 3;
    this.rows = Math.ceil((bottom - top) / this.step) + 3;
    this.slack = 0.004 * surface.box.diagonal;
    this.depths = new Float32Array(this.columns * this.rows).fill(Infinity);
    for (let i = 0; i < this.depths.length; ++i) {
      const ray = projector.rayAt(
        this.left + this.step * (i % this.columns),
        this.top + this.step * Math.floor(i / this.columns),
      );
      const hit = tree.raycast(ray.origin.clone().sub(surface.object.position), ray.direction);
      if (hit !== undefined) this.depths[i] = this.depthOf(ray.at(hit.distance, new Vector3()));
    }
  }

  /** Returns whether a point is visible: at most as deep as the surface around its pixel, within a tolerance. */
  shows(position: Vector3): boolean {
    const { x, y } = this.projector.pixelOf(position);
    const column = Math.floor((x - this.left) / this.step);
    const row = Math.floor((y - this.top) / this.step);
    let deepest = 0;
    for (let i = 0; i < 4; ++i) {
      const depth = this.depths[(row + (i >> 1)) * this.columns + column + (i & 1)] ?? 0;
      if (depth < Infinity) deepest = Math.max(deepest, depth);
    }
    return deepest === 0 || this.depthOf(position) <= deepest + this.slack;
  }

  private depthOf(position: Vector3): number {
    return this.projector.depthOf(position);
  }
}
