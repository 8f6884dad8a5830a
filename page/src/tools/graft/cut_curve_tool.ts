import { forFingers } from "../../app/pointer_kind";
import { effect } from "@preact/signals";
import { Vector3 } from "three";
import type { GraftView } from "../../view/graft/graft_view";
import type { Hit } from "../../view/picking/picking";
import type { ScreenPoint } from "../screen_camera";
import { runsLeft } from "./graft_plane_math";
import { linesThrough, onOverlay, set, show, svg } from "../svg";
import { clickStroke, type ToolContext, type Pointer, type Stroke, type Tool } from "../tool";

const stepPx = 9; // between vertices of the curve
const closePx = 16;

/** Draws a closed curve on the surface to cut along, in one or several strokes, between which the view can turn. */
export class CutCurveTool implements Tool {
  readonly cursor = "crosshair";
  private readonly path = svg("path", { class: "cut-curve", display: "none" });
  private readonly first = svg("circle", { class: "cut-first", r: 7, display: "none" });

  constructor(
    private readonly context: ToolContext,
    private readonly view: GraftView,
  ) {
    context.viewport.overlay.append(this.path, this.first);
    context.viewport.onFrame.add(() => this.draw());
    effect(() => {
      void [this.graft.cutCurve.value, this.graft.tool.value, this.graft.mode.value];
      context.viewport.requestRender();
    });
  }

  private get graft() {
    return this.context.editor.graft;
  }

  hover(pointer: Pointer, hit: Hit | undefined): void {
    const { value: curve } = this.graft.cutCurve;
    if (this.isAtFirst(pointer.screenPoint)) this.context.status.say(forFingers("Click to close the curve"), pointer.screenPoint);
    else if (hit === undefined) this.context.status.clear();
    else if (curve?.closed === true) this.context.status.say("Enter keeps the inside", pointer.screenPoint);
    else if (curve === null) this.context.status.say("Draw a closed curve on the surface", pointer.screenPoint);
    else this.context.status.say("Keep drawing; Enter closes the curve", pointer.screenPoint);
  }
  leave(): void {
    this.context.status.clear();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    if (this.isAtFirst(pointer.screenPoint)) return clickStroke(() => this.close());
    if (hit === undefined) return undefined;
    const before = this.graft.cutCurve.value;
    const goesOn = before !== null && !before.closed && before.mesh === hit.surface.id;
    const vertices = goesOn ? [...before.vertices] : [];
    let last: ScreenPoint | undefined;
    const add = ({ screenPoint }: Pointer) => {
      if (last !== undefined && Math.hypot(screenPoint.x - last.x, screenPoint.y - last.y) < stepPx) return;
      const under = this.context.viewport.pick(screenPoint.x, screenPoint.y);
      if (under?.surface !== hit.surface || vertices.includes(under.vertex)) return;
      last = screenPoint;
      vertices.push(under.vertex);
      this.graft.cutCurve.value = { mesh: hit.surface.id, vertices: [...vertices], closed: false };
    };
    add(pointer);
    return {
      followsPath: true,
      move: add,
      end: ({ screenPoint }) => {
        if (vertices.length > 4 && this.isAtFirst(screenPoint)) this.close();
      },
      cancel: () => (this.graft.cutCurve.value = before),
    };
  }

  confirm(): boolean {
    const { value: curve } = this.graft.cutCurve;
    if (curve === null || curve.vertices.length < 3) return false;
    if (curve.closed) void this.graft.cut("above");
    else this.close();
    return true;
  }
  escape(): boolean {
    if (this.graft.cutCurve.value === null) return false;
    this.graft.cutCurve.value = null;
    return true;
  }
  takeKey({ key }: KeyboardEvent): boolean {
    const { value: curve } = this.graft.cutCurve;
    if (curve === null || (key !== "Backspace" && key !== "Delete")) return false;
    const vertices = curve.vertices.slice(0, curve.closed ? undefined : -1);
    this.graft.cutCurve.value = vertices.length === 0 ? null : { ...curve, vertices, closed: false };
    return true;
  }

  // Closes the curve counter-clockwise as seen on the screen. Its inside is then at its left, the side that the engine
  // calls above.
  private close(): void {
    const { value: curve } = this.graft.cutCurve;
    if (curve === null || curve.vertices.length < 3) return;
    const screenPoints = this.screenPoints().map(({ x, y }): [number, number] => [x, y]);
    const vertices = runsLeft(screenPoints) ? curve.vertices : [...curve.vertices].reverse();
    this.graft.cutCurve.value = { ...curve, vertices, closed: true };
  }

  private isAtFirst(screenPoint: ScreenPoint): boolean {
    const { value: curve } = this.graft.cutCurve;
    if (curve === null || curve.closed || curve.vertices.length < 3) return false;
    const [first] = this.screenPoints();
    return first !== undefined && Math.hypot(first.x - screenPoint.x, first.y - screenPoint.y) < closePx;
  }

  private screenPoints(): ScreenPoint[] {
    const { value: curve } = this.graft.cutCurve;
    if (curve === null) return [];
    const position = new Vector3();
    return curve.vertices.flatMap((v) => {
      const at = this.view.positionOf(curve.mesh, v, position);
      return at === undefined ? [] : [this.context.viewport.project(at)];
    });
  }

  private draw(): void {
    const { cutCurve, mode, tool } = this.graft;
    const isShown = mode.value === "graft" && tool.value === "stroke" && cutCurve.value !== null;
    show(this.path, isShown);
    show(this.first, isShown && cutCurve.value?.closed === false && cutCurve.value.vertices.length > 2);
    if (!isShown) return;
    const screenPoints = onOverlay(this.context.viewport.overlay, this.screenPoints());
    const closed = cutCurve.value?.closed === true;
    set(this.path, { d: linesThrough(screenPoints, closed), class: `cut-curve${closed ? " closed" : ""}` });
    const [first] = screenPoints;
    if (first !== undefined) set(this.first, { cx: first.x, cy: first.y });
  }
}
