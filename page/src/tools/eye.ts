import type { Ray } from "three";
import { Vector3 } from "three";
import type { Viewport } from "../view/viewport";

/** A place on the page, in its pixels. */
export interface Spot {
  readonly x: number;
  readonly y: number;
}

/** How space is seen on the page: what gestures and the gizmo need of a camera. */
export interface Eye {
  project(point: Vector3): { x: number; y: number; behind: boolean };
  /** From the eye through a place on the page. */
  rayAt(spot: Spot): Ray;
  /** From the eye towards a point, of length 1. */
  towards(point: Vector3): Vector3;
  worldPerPixel(point: Vector3): number;
}

export function eyeOf(viewport: Viewport): Eye {
  return {
    project: (point) => viewport.project(point),
    rayAt: ({ x, y }) => viewport.rayAt(x, y),
    towards: (point) =>
      viewport.orthographic
        ? viewport.camera.getWorldDirection(new Vector3())
        : point.clone().sub(viewport.camera.position).normalize(),
    worldPerPixel: (point) => viewport.worldPerPixel(point),
  };
}
