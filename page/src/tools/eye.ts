import { OrthographicCamera, Ray, Raycaster, Vector2, Vector3, type PerspectiveCamera } from "three";

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

/** The eye of a camera that draws into `canvas`. */
export class CameraEye implements Eye {
  constructor(
    private readonly camera: () => PerspectiveCamera | OrthographicCamera,
    private readonly canvas: () => { getBoundingClientRect(): DOMRect },
  ) {}

  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.canvas().getBoundingClientRect();
    const at = point.clone().project(this.camera());
    return { x: box.x + ((at.x + 1) / 2) * box.width, y: box.y + ((1 - at.y) / 2) * box.height, behind: at.z > 1 };
  }

  rayAt({ x, y }: Spot): Ray {
    const box = this.canvas().getBoundingClientRect();
    const caster = new Raycaster();
    const at = new Vector2((2 * (x - box.x)) / box.width - 1, 1 - (2 * (y - box.y)) / box.height);
    caster.setFromCamera(at, this.camera());
    return caster.ray;
  }

  towards(point: Vector3): Vector3 {
    const camera = this.camera();
    if (camera instanceof OrthographicCamera) return camera.getWorldDirection(new Vector3());
    return point.clone().sub(camera.position).normalize();
  }

  worldPerPixel(point: Vector3): number {
    const { height } = this.canvas().getBoundingClientRect();
    const camera = this.camera();
    if (camera instanceof OrthographicCamera) return (camera.top - camera.bottom) / (camera.zoom * height);
    const depth = point.clone().sub(camera.position).dot(camera.getWorldDirection(new Vector3()));
    const half = Math.tan((camera.getEffectiveFOV() * Math.PI) / 360);
    return (2 * Math.max(depth, camera.near) * half) / height;
  }
}
