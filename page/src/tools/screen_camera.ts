import type { Ray } from "three";
import { Vector3 } from "three";
import type { Viewport } from "../view/viewport";

/** A point of the page, in its pixels. */
export interface ScreenPoint {
  readonly x: number;
  readonly y: number;
}

/** What gestures and the gizmo need of a camera. */
export interface ScreenCamera {
  project(point: Vector3): { x: number; y: number; behind: boolean };
  /** The ray through a point of the page. */
  rayAt(screenPoint: ScreenPoint): Ray;
  /** From the camera towards a point, of length 1. */
  towards(point: Vector3): Vector3;
  worldPerPixel(point: Vector3): number;
}

export function screenCameraOf(viewport: Viewport): ScreenCamera {
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
