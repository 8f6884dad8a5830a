import { Matrix4, Quaternion, Vector3 } from "three";
import type { Cut } from "../../app/cuts";
import type { Graft } from "../../app/graft/graft";
import type { GraftView } from "../../view/graft/graft_view";
import type { Viewport } from "../../view/viewport";
import type { ScreenCamera, ScreenPoint } from "../screen_camera";
import type { GestureKind } from "../gesture";
import { planeThroughLine, type CutPlane } from "./graft_plane_math";
import type { Movable, Moved } from "../movable";
import { axesOf, centreOf, type Placement } from "../pose_math";
import { linesThrough, onOverlay, set, show, svg } from "../svg";
import type { ToolContext, Pointer, Stroke, Tool } from "../tool";
import type { Hit } from "../../view/picking/picking";

const name = "cutting plane";
const betweenPicksPx = 6;
const up = new Vector3(0, 0, 1);

/** Maps the cutting plane to world coordinates, and lets the gizmo move and turn it. */
export class PlaneControl implements Movable {
  readonly gestureKinds: readonly GestureKind[] = ["move", "turn"];

  constructor(
    private readonly viewport: Viewport,
    private readonly graft: Graft,
    private readonly view: GraftView,
  ) {}

  get active(): Moved | undefined {
    const { mode, tool, cutPlane } = this.graft;
    if (mode.value !== "graft" || tool.value !== "plane" || cutPlane.value === null) return undefined;
    const { point, normal } = this.inWorld(cutPlane.value);
    const turn = new Quaternion().setFromUnitVectors(up, normal);
    const angle = 2 * Math.acos(Math.min(1, Math.abs(turn.w)));
    const axis = new Vector3(turn.x, turn.y, turn.z).multiplyScalar(turn.w < 0 ? -1 : 1);
    const placement: Placement = {
      kind: "motion",
      translate: new Vector3(),
      turn: { axis: axis.lengthSq() > 0 ? axis.normalize() : up.clone(), angleDeg: (180 * angle) / Math.PI },
      scale: new Vector3(1, 1, 1),
      pivot: point,
    };
    return { name, placement, defaultPivot: point };
  }

  show(_name: string, placement: Placement): void {
    const { value: cut } = this.graft.cutPlane;
    if (cut === null) return;
    const normal = up.clone().applyQuaternion(axesOf(placement));
    this.set(cut.mesh, { point: centreOf(placement), normal });
  }
  async commit(_name: string, placement: Placement): Promise<void> {
    this.show(name, placement);
  }
  revert(_name: string, placement: Placement): void {
    this.show(name, placement);
  }

  /** Sets the cutting plane of a mesh from a plane in world coordinates. */
  set(mesh: number, { point, normal }: CutPlane): void {
    const matrixWorld = this.view.matrixWorldOf(mesh);
    const own = point.clone().applyMatrix4(matrixWorld.clone().invert());
    const turned = normalThrough(normal, matrixWorld.clone().invert());
    this.graft.cutPlane.value = { mesh, plane: { point: own.toArray(), normal: turned.toArray() } };
    this.viewport.requestRender();
  }
  /** Returns the centre of a mesh as shown, in world coordinates. */
  centreOfMesh(mesh: number): Vector3 | undefined {
    return this.viewport.surfaceOf(mesh)?.sphere().center.applyMatrix4(this.view.matrixWorldOf(mesh));
  }
  /** Returns the diagonal of a mesh's box as shown, in world units. */
  sizeOf(mesh: number): number {
    const scale = Math.cbrt(Math.abs(this.view.matrixWorldOf(mesh).determinant()));
    return scale * (this.viewport.surfaceOf(mesh)?.box.diagonal ?? 1);
  }
  inWorld({ mesh, plane }: Cut): CutPlane {
    const matrixWorld = this.view.matrixWorldOf(mesh);
    const point = new Vector3(...plane.point).applyMatrix4(matrixWorld);
    return { point, normal: normalThrough(new Vector3(...plane.normal), matrixWorld) };
  }
}

// The world matrix of a shown mesh is a similarity, so normals transform as directions do.
function normalThrough(normal: Vector3, matrix: Matrix4): Vector3 {
  return normal.clone().transformDirection(matrix);
}

/**
 * Places the cutting plane through a line drawn across a model or a part and through the camera. The line may begin
 * off the object. It cuts the object that it begins on or meets first.
 */
export class CutPlaneTool implements Tool {
  readonly cursor = "crosshair";
  readonly beginsOffSurface = true;
  private readonly line = svg("path", { class: "cut-line", display: "none" });

  constructor(
    private readonly context: ToolContext,
    private readonly control: PlaneControl,
  ) {
    context.viewport.overlay.append(this.line);
  }

  hover({ screenPoint }: Pointer): void {
    if (this.control.active === undefined) this.context.status.say("Draw a line across what you want to cut", screenPoint);
  }
  leave(): void {
    this.context.status.clear();
    show(this.line, false);
  }

  press({ screenPoint: first }: Pointer, hit: Hit | undefined): Stroke | undefined {
    const { overlay } = this.context.viewport;
    this.context.status.clear();
    const follow = ({ screenPoint }: Pointer) => this.setPlane(hit ?? this.firstBetween(first, screenPoint), first, screenPoint);
    return {
      move: (pointer) => {
        show(this.line, true);
        set(this.line, { d: linesThrough(onOverlay(overlay, [first, pointer.screenPoint])) });
        follow(pointer);
      },
      end: (pointer) => {
        show(this.line, false);
        follow(pointer);
      },
      cancel: () => show(this.line, false),
    };
  }

  // Returns the first hit of a line that begins off all surfaces.
  private firstBetween(first: ScreenPoint, last: ScreenPoint): Hit | undefined {
    const count = Math.ceil(Math.hypot(last.x - first.x, last.y - first.y) / betweenPicksPx);
    for (let i = 1; i <= count; ++i) {
      const t = i / count;
      const hit = this.context.viewport.pick(first.x + t * (last.x - first.x), first.y + t * (last.y - first.y));
      if (hit !== undefined) return hit;
    }
    return undefined;
  }

  private setPlane(hit: Hit | undefined, first: ScreenPoint, last: ScreenPoint): void {
    if (hit === undefined || Math.hypot(last.x - first.x, last.y - first.y) < 12) return;
    const { camera } = this.context;
    const [a, b] = [atDepthOf(camera, hit.point, first), atDepthOf(camera, hit.point, last)];
    const plane = planeThroughLine(a, b, camera.towards(a), camera.towards(b));
    if (plane !== undefined) this.control.set(hit.surface.id, this.withPointInMesh(plane, hit));
  }

  // Moves the plane's point to the point of the plane nearest to the mesh's centre, so that the gizmo is inside the
  // mesh.
  private withPointInMesh({ point, normal }: CutPlane, hit: Hit): CutPlane {
    const centre = this.control.centreOfMesh(hit.surface.id) ?? point;
    return { point: centre.addScaledVector(normal, point.clone().sub(centre).dot(normal)), normal };
  }
}

/** Returns the point of the world under a screen point, at the depth of `point`. */
function atDepthOf(camera: ScreenCamera, point: Vector3, screenPoint: ScreenPoint): Vector3 {
  const ray = camera.rayAt(screenPoint);
  const along = camera.towards(point);
  const depth = point.clone().sub(ray.origin).dot(along) / ray.direction.dot(along);
  return ray.origin.clone().addScaledVector(ray.direction, depth);
}
