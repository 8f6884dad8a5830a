import { OrthographicCamera, Raycaster, Vector2, Vector3, type PerspectiveCamera, type Ray } from "three";
import type { ScreenCamera, ScreenPoint } from "../../src/tools/screen_camera";

/** A camera that draws into `canvas`. */
export class CanvasCamera implements ScreenCamera {
  constructor(
    private readonly camera: () => PerspectiveCamera | OrthographicCamera,
    private readonly canvas: () => { getBoundingClientRect(): DOMRect },
  ) {}

  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.canvas().getBoundingClientRect();
    const at = point.clone().project(this.camera());
    return { x: box.x + ((at.x + 1) / 2) * box.width, y: box.y + ((1 - at.y) / 2) * box.height, behind: at.z > 1 };
  }

  rayAt({ x, y }: ScreenPoint): Ray {
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
