import { Matrix4, Vector3 } from "three";
import type { Box, Editor } from "../../app/editor";
import type { Pair, Rows4, StartCandidate, Vector3Tuple } from "../../app/graft/graft_step";
import type { GraftActions } from "../../app/page";
import type { LoopRef } from "../../app/graft/graft";
import { axisNames, normalOfTilt, tiltOf, type PlaneTilt } from "../../app/graft/plane_tilt";
import { boxOfPositions } from "../../app/shown_box";
import { matrixOfRows, rowsOfMatrix } from "../../view/graft/graft_view";
import { StartPictures } from "../../view/graft/start_pictures";
import type { Viewport } from "../../view/viewport";
import type { DropTool } from "./drop_tool";
import type { ScreenPoint } from "../screen_camera";
import type { Pointer } from "../tool";

const dragPx = 7; // a press that moves farther is a drag

/** Implements the functions of the tools that the graft panel uses. */
export class GraftPanelActions implements GraftActions {
  private readonly pictures: StartPictures;
  private tiltedFrom: 0 | 1 | 2 = 2; // axis from which the cutting plane was tilted last

  constructor(
    private readonly editor: Editor,
    private readonly viewport: Viewport,
    private readonly dropTool: DropTool,
    /** Moves the focus into the view, with the cursor of the keyboard at a point. */
    private readonly focusCursor: (at: ScreenPoint) => void,
  ) {
    this.pictures = new StartPictures(viewport, editor.graft);
  }

  dragPart(add: () => Promise<string | undefined>, press: PointerEvent): void {
    if (press.button !== 0 || this.editor.graft.isEdited.value) return;
    let begun: Promise<boolean> | undefined;
    let last: PointerEvent = press;
    const move = (event: PointerEvent) => {
      if (event.pointerId !== press.pointerId) return;
      last = event;
      const far = Math.hypot(event.clientX - press.clientX, event.clientY - press.clientY);
      if (begun === undefined && far > dragPx) begun = this.begin(add, () => this.follow(last));
      if (this.editor.graft.dropped.value !== null) this.follow(event);
    };
    const end = () => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", up);
      window.removeEventListener("pointercancel", lose);
    };
    const lose = (event: PointerEvent) => {
      if (event.pointerId !== press.pointerId) return;
      end();
      void begun?.then((begun) => begun && this.dropTool.cancel());
    };
    const up = (event: PointerEvent) => {
      if (event.pointerId !== press.pointerId) return;
      end();
      if (begun === undefined) return;
      window.addEventListener("click", swallow, { capture: true, once: true }); // the click on the thumbnail
      setTimeout(() => window.removeEventListener("click", swallow, { capture: true }));
      void begun.then((begun) => (begun ? this.finish(event) : undefined));
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", up);
    window.addEventListener("pointercancel", lose);
  }

  async dropByClick(add: () => Promise<string | undefined>, isByKey = false): Promise<void> {
    const { graft } = this.editor;
    if (graft.isEdited.value || !(await this.begin(add)) || !isByKey) return;
    const start = this.dropTool.startPoint();
    if (start !== undefined) this.focusCursor(start);
    this.editor.announce(
      `${graft.dropped.value?.name ?? "The part"} follows the cursor over the surface. Arrow keys move it, R turns it, S scales it, Space or Enter grafts it, Escape cancels.`,
    );
  }

  private async begin(add: () => Promise<string | undefined>, then = () => {}): Promise<boolean> {
    const name = await this.editor.graft.beginDrop(add);
    if (name !== undefined) then();
    return name !== undefined;
  }

  private follow(event: PointerEvent): void {
    if (this.isOverView(event)) this.dropTool.hover(pointerOf(event), undefined);
  }
  private async finish(event: PointerEvent): Promise<void> {
    if (this.editor.graft.dropped.value === null) return; // the drop was cancelled
    const at = pointerOf(event);
    if (this.isOverView(event) && this.dropTool.isOverTarget(at.screenPoint)) {
      this.dropTool.hover(at, undefined);
      await this.dropTool.finish();
    } else await this.dropTool.cancelMissed();
  }
  private isOverView(event: PointerEvent): boolean {
    return document.elementFromPoint(event.clientX, event.clientY) === this.viewport.canvas;
  }

  setPlane(mesh: number, axis: 0 | 1 | 2): void {
    const surface = this.viewport.surfaceOf(mesh);
    if (surface === undefined) return;
    const normal: Vector3Tuple = [0, 0, 0];
    normal[axis] = 1;
    this.tiltedFrom = axis;
    this.editor.graft.tool.value = "plane";
    this.editor.graft.cutPlane.value = { mesh, plane: { point: this.centreOf(mesh), normal } };
    this.viewport.requestRender();
    const name = this.editor.graft.byMesh(mesh)?.name ?? "the mesh";
    this.editor.announce(`The plane cuts ${name} across ${axisNames[axis]}, through its middle.`);
  }
  planeTilt(): PlaneTilt | undefined {
    const { value: cut } = this.editor.graft.cutPlane;
    return cut === null ? undefined : tiltOf(cut.plane.normal, this.tiltedFrom);
  }
  tiltPlane(tilt: PlaneTilt): void {
    const { cutPlane } = this.editor.graft;
    if (cutPlane.value === null) return;
    const { mesh, plane } = cutPlane.value;
    this.tiltedFrom = tilt.axis;
    cutPlane.value = { mesh, plane: { point: plane.point, normal: normalOfTilt(tilt) } };
    this.viewport.requestRender();
  }
  loopCentre({ mesh, loop }: LoopRef): Vector3Tuple | undefined {
    const vertices = this.editor.graft.loops.value.get(mesh)?.[loop]?.vertices;
    const surface = this.viewport.surfaceOf(mesh);
    if (vertices === undefined || surface === undefined) return undefined;
    const sum = new Vector3();
    for (const v of vertices) sum.add(surface.positionOf(v));
    return sum.divideScalar(Math.max(1, vertices.length)).toArray();
  }
  planeOffset(): { offset: number; limit: number } | undefined {
    const { value: cut } = this.editor.graft.cutPlane;
    const surface = this.viewport.surfaceOf(cut?.mesh ?? -1);
    if (cut === null || surface === undefined) return undefined;
    const normal = new Vector3(...cut.plane.normal);
    const size = surface.box.max.clone().sub(surface.box.min);
    const limit = 0.5 * (Math.abs(normal.x) * size.x + Math.abs(normal.y) * size.y + Math.abs(normal.z) * size.z);
    const offset = new Vector3(...cut.plane.point).sub(new Vector3(...this.centreOf(cut.mesh))).dot(normal);
    return { offset: Math.abs(offset) < 1e-6 * limit ? 0 : offset, limit };
  }
  movePlane(offset: number): void {
    const { cutPlane } = this.editor.graft;
    const current = this.planeOffset();
    if (cutPlane.value === null || current === undefined) return;
    const { mesh, plane } = cutPlane.value;
    const point = new Vector3(...plane.point).addScaledVector(new Vector3(...plane.normal), offset - current.offset);
    cutPlane.value = { mesh, plane: { point: point.toArray(), normal: plane.normal } };
    this.viewport.requestRender();
  }

  centreOf(mesh: number): Vector3Tuple {
    return this.viewport.surfaceOf(mesh)?.sphere().center.toArray() ?? [0, 0, 0];
  }

  boxOf(mesh: number): Box | null {
    const surface = this.viewport.surfaceOf(mesh);
    return surface === undefined ? null : boxOfPositions(surface.positions, surface.offset);
  }

  startPicture(pair: Pair, candidate: StartCandidate): Promise<string> | undefined {
    return this.pictures.picture(pair, candidate);
  }

  /** Returns the found pose without the mirror, which is applied before it. */
  foundPose(): Rows4 | null {
    const { report, step } = this.editor.graft;
    const found = report.value?.transform;
    if (found === undefined) return null;
    const whole = matrixOfRows(found);
    const { mirror } = step.value ?? {};
    if (mirror === undefined) return rowsOfMatrix(whole);
    return rowsOfMatrix(whole.multiply(reflection(new Vector3(...mirror.point), new Vector3(...mirror.normal).normalize())));
  }
}

function swallow(event: MouseEvent): void {
  event.stopPropagation();
  event.preventDefault();
}

function pointerOf(event: PointerEvent): Pointer {
  return {
    screenPoint: { x: event.clientX, y: event.clientY },
    shift: event.shiftKey,
    ctrl: event.ctrlKey || event.metaKey,
    alt: event.altKey,
  };
}

function reflection(point: Vector3, n: Vector3): Matrix4 {
  const linear = new Matrix4().set(
    1 - 2 * n.x * n.x, -2 * n.x * n.y, -2 * n.x * n.z, 0,
    -2 * n.x * n.y, 1 - 2 * n.y * n.y, -2 * n.y * n.z, 0,
    -2 * n.x * n.z, -2 * n.y * n.z, 1 - 2 * n.z * n.z, 0,
    0, 0, 0, 1,
  );
  return linear.setPosition(n.clone().multiplyScalar(2 * point.dot(n)));
}
