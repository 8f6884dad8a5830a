import { Matrix4, Ray, Vector2, Vector3, type OrthographicCamera, type PerspectiveCamera } from "three";
import type { Navigation } from "./navigation";
import type { Surface } from "./surface/surface";
import type { Sight } from "./picking/visibility";

/** Where places of the world are on the page, and the other way round. */
export class Projection {
  constructor(
    private readonly navigation: Navigation,
    private readonly canvas: () => HTMLCanvasElement,
  ) {}

  private get camera(): PerspectiveCamera | OrthographicCamera {
    return this.navigation.camera;
  }
  private box(): DOMRect {
    return this.canvas().getBoundingClientRect();
  }

  /** Of the world, for a pixel of the page at the depth of `point`. */
  worldPerPixel(point: Vector3): number {
    const height = Math.max(1, this.canvas().clientHeight);
    const { navigation } = this;
    if (navigation.orthographic) return navigation.viewHeight / height;
    const depth = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
    return (Math.abs(depth) * navigation.viewHeight) / (navigation.distance * height);
  }

  /** Where a place of the world is on the page; `behind` the camera. */
  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.box();
    const behind = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z > 0 && !this.navigation.orthographic;
    const p = point.clone().project(this.camera);
    return { x: box.left + 0.5 * (p.x + 1) * box.width, y: box.top + 0.5 * (1 - p.y) * box.height, behind };
  }

  /** The ray of the world through a place of the page. */
  rayAt(clientX: number, clientY: number): Ray {
    const box = this.box();
    const at = new Vector2((2 * (clientX - box.left)) / box.width - 1, 1 - (2 * (clientY - box.top)) / box.height);
    const far = new Vector3(at.x, at.y, 0.5).unproject(this.camera);
    if (!this.navigation.orthographic) {
      const origin = this.camera.position.clone();
      return new Ray(origin, far.sub(origin).normalize());
    }
    const along = new Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
    return new Ray(new Vector3(at.x, at.y, -1).unproject(this.camera), along);
  }

  /** Where a place is seen from; in a parallel view, far away for a scene of this radius. */
  from(point: Vector3, sceneRadius: number): Vector3 {
    if (!this.navigation.orthographic) return this.camera.position.clone();
    const back = new Vector3(0, 0, 1).applyQuaternion(this.camera.quaternion);
    return back.multiplyScalar(1e4 * sceneRadius).add(point);
  }

  /** Functions of places that are asked for many, so they allocate nothing. */
  sight(): Sight {
    const { camera } = this;
    const box = this.box();
    const toView = camera.matrixWorldInverse.clone();
    const eye = this.camera.position.clone();
    const back = new Vector3(0, 0, 1).applyQuaternion(camera.quaternion);
    const p = new Vector3();
    return {
      rayAt: (x, y) => this.rayAt(x, y),
      towardsEye: (place, out) => (this.navigation.orthographic ? out.copy(back) : out.copy(eye).sub(place)),
      depthOf: (place) => -p.copy(place).applyMatrix4(toView).z,
      pixelOf: (place) => {
        p.copy(place).project(camera);
        return { x: box.left + 0.5 * (p.x + 1) * box.width, y: box.top + 0.5 * (1 - p.y) * box.height };
      },
    };
  }

  /** From a surface's own places to the clip box, and the canvas on the page. */
  toClip(surface: Surface): { matrix: ArrayLike<number>; box: DOMRect } {
    const { camera } = this;
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const place = new Matrix4().makeTranslation(surface.object.position);
    return { matrix: matrix.multiply(place).elements, box: this.box() };
  }
}
