import { effect, untracked } from "@preact/signals";
import type { Vector3 } from "three";
import { layingPose } from "../app/placing";
import { lengthText } from "../view/view_notes";
import type { Hit } from "../view/picking/picking";
import type { ScreenPoint } from "./screen_camera";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import { clickStroke, type Pointer, type Stroke, type Tool, type ToolContext } from "./tool";

/** Measures the distance of two clicked points, which can then be typed anew to scale the model. */
export class MeasureTool implements Tool {
  readonly cursor = "crosshair";
  private first: Vector3 | undefined;
  private second: Vector3 | undefined;
  private ahead: Vector3 | undefined;
  private readonly line = svg("path", { class: "measured-line" });
  private readonly ends = [svg("circle", { r: 5 }), svg("circle", { r: 5 })] as const;
  private readonly element = svg("g", { class: "measured", display: "none" }, this.line, ...this.ends);

  constructor(private readonly context: ToolContext) {
    context.viewport.overlay.append(this.element);
    context.viewport.onFrame.add(() => this.draw());
    effect(() => {
      void context.editor.tools.modelChanges.value;
      untracked(() => this.clear());
    });
  }

  hover({ screenPoint }: Pointer, hit: Hit | undefined): void {
    const { status, viewport, editor } = this.context;
    this.ahead = this.second === undefined ? hit?.point : undefined;
    const isMeasuring = this.first !== undefined && this.second === undefined && hit !== undefined;
    if (isMeasuring && this.first !== undefined)
      status.say(lengthText(this.first.distanceTo(hit.point), editor.view.unit.value), screenPoint);
    else status.clear();
    viewport.requestRender();
  }
  leave(): void {
    this.ahead = undefined;
    this.context.status.clear();
    this.context.viewport.requestRender();
  }

  press(_pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    return hit === undefined ? undefined : clickStroke(() => this.click(hit.point));
  }

  /** Forgets the clicked points. Returns whether there were any. */
  escape(): boolean {
    const had = this.first !== undefined;
    this.clear();
    return had;
  }

  private click(point: Vector3): void {
    if (this.first === undefined || this.second !== undefined) {
      this.clear();
      this.first = point.clone();
    } else if (point.distanceTo(this.first) > 0) {
      this.second = point.clone();
      this.context.editor.tools.measured.value = this.first.distanceTo(this.second);
      this.context.status.clear();
    }
    this.context.viewport.requestRender();
  }

  private clear(): void {
    this.first = this.second = undefined;
    this.context.editor.tools.measured.value = null;
    this.context.viewport.requestRender();
  }

  private draw(): void {
    const { viewport, editor } = this.context;
    if (this.second !== undefined && editor.tools.measured.value === null) this.first = this.second = undefined; // it was scaled
    const to = this.second ?? this.ahead;
    const seen = [this.first, to].filter((point) => point !== undefined).map((point) => viewport.project(point));
    const isActive = editor.tools.tool.value === "measure" && editor.graft.mode.value === "deform";
    show(this.element, isActive && seen.length > 0 && !seen.some(({ behind }) => behind));
    const points = onOverlay(viewport.overlay, seen);
    set(this.line, { d: linesThrough(points) });
    this.ends.forEach((end, k) => {
      const at = points[k] as ScreenPoint | undefined;
      show(end, at !== undefined);
      if (at !== undefined) set(end, { cx: at.x, cy: at.y });
    });
  }
}

/** Lays the model flat on a clicked face. */
export class LayFlatTool implements Tool {
  readonly cursor = "pointer";

  constructor(private readonly context: ToolContext) {}

  hover({ screenPoint }: Pointer, hit: Hit | undefined): void {
    if (hit === undefined) this.context.status.clear();
    else this.context.status.say("Lay flat on this face", screenPoint);
  }
  leave(): void {
    this.context.status.clear();
  }

  press(_pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    return hit === undefined ? undefined : clickStroke(() => void this.lay(hit));
  }

  private async lay({ surface, normal, facing }: Hit): Promise<void> {
    const { editor, viewport, status } = this.context;
    status.clear();
    const outward = facing ? normal : normal.clone().negate(); // the side that is seen lies on the bed
    const pose = layingPose(outward, viewport.navigation.axes()[2], surface.positions, surface.offset);
    if ((await editor.ask({ do: "transform", pose })) === undefined) return;
    editor.tools.tool.value = "navigate";
    viewport.fit("all");
  }
}
