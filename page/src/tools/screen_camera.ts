import type { Ray } from "three";
import { Vector3 } from "three";
import type { Viewport } from "../view/viewport";

/** A point of the page, in CSS pixels. */
export interface ScreenPoint {
  readonly x: number;
  readonly y: number;
}

/** The functions of a camera that gestures and the gizmo use. */
export interface ScreenCamera {
  project(point: Vector3): { x: number; y: number; behind: boolean };
  /** Returns the ray through a point of the page. */
  rayAt(screenPoint: ScreenPoint): Ray;
  /** Returns the unit direction from the camera towards a point. */
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
