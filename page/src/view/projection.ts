import { Matrix4, Ray, Vector2, Vector3, type OrthographicCamera, type PerspectiveCamera } from "three";
import type { Navigation } from "./navigation";
import type { Surface } from "./surface/surface";
import type { ScreenProjector } from "./picking/visibility";
import { pageBox } from "./page_box";

/** Projects world points to the page, and points of the page to rays. */
export class Projection {
  constructor(
    private readonly navigation: Navigation,
    private readonly canvas: () => HTMLCanvasElement,
  ) {}

  private get camera(): PerspectiveCamera | OrthographicCamera {
    return this.navigation.camera;
  }
  private box(): DOMRect {
    return pageBox(this.canvas());
  }

  /** Returns the world length of a CSS pixel at the depth of `point`. */
  worldPerPixel(point: Vector3): number {
    const height = Math.max(1, this.canvas().clientHeight);
    const { navigation } = this;
    if (navigation.orthographic) return navigation.viewHeight / height;
    const depth = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
    return (Math.abs(depth) * navigation.viewHeight) / (navigation.distance * height);
  }

  /** Returns the point of the page of a world point, and whether it is `behind` the camera. */
  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.box();
    const behind = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z > 0 && !this.navigation.orthographic;
    const p = point.clone().project(this.camera);
    return { x: box.left + 0.5 * (p.x + 1) * box.width, y: box.top + 0.5 * (1 - p.y) * box.height, behind };
  }

  /** Returns the world ray through a point of the page. */
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

  /**
   * Returns the position from which a point is seen. In a parallel view this is far away, relative to a scene of this
   * radius.
   */
  cameraPositionFor(point: Vector3, sceneRadius: number): Vector3 {
    if (!this.navigation.orthographic) return this.camera.position.clone();
    const back = new Vector3(0, 0, 1).applyQuaternion(this.camera.quaternion);
    return back.multiplyScalar(1e4 * sceneRadius).add(point);
  }

  /** Returns functions for many points, which therefore allocate little. */
  projector(): ScreenProjector {
    const { camera } = this;
    const box = this.box();
    const toView = camera.matrixWorldInverse.clone();
    const cameraPosition = this.camera.position.clone();
    const back = new Vector3(0, 0, 1).applyQuaternion(camera.quaternion);
    const p = new Vector3();
    return {
      rayAt: (x, y) => this.rayAt(x, y),
      towardsCamera: (position, out) => (this.navigation.orthographic ? out.copy(back) : out.copy(cameraPosition).sub(position)),
      depthOf: (position) => -p.copy(position).applyMatrix4(toView).z,
      pixelOf: (position) => {
        p.copy(position).project(camera);
        return { x: box.left + 0.5 * (p.x + 1) * box.width, y: box.top + 0.5 * (1 - p.y) * box.height };
      },
    };
  }

  /** Returns the matrix from a surface's own coordinates to clip coordinates, and the canvas's box on the page. */
  toClip(surface: Surface): { matrix: ArrayLike<number>; box: DOMRect } {
    const { camera } = this;
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const translation = new Matrix4().makeTranslation(surface.object.position);
    return { matrix: matrix.multiply(translation).elements, box: this.box() };
  }
}
