import { effect } from "@preact/signals";
import { Vector3 } from "three";
import type { ScreenPoint } from "./screen_camera";
import { distanceToSegment } from "./gizmo_layout";
import type { ActiveHandle } from "./handle_control";
import { centreOf, matrixOf } from "./pose_math";
import type { Preview } from "./preview";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import type { ToolContext, Pointer, Stroke } from "./tool";

const knobPx = 150; // from the gizmo's centre, beyond its rings
const mostVertices = 300_000;
const stemPx = 18;

/**
 * A knob beside the gizmo that sets the reach of the active handle, by dragging away from the gizmo or towards it. The
 * region within the reach, measured along edges like the engine does, lights up meanwhile. It also lights up while the
 * panel's slider moves.
 */
export class ReachKnob {
  private readonly stem = svg("path", { class: "reach-stem" });
  private readonly halo = svg("circle", { class: "reach-halo", r: 8 });
  private readonly knob = svg("circle", { class: "reach-knob", r: 6 });
  private readonly element = svg("g", { class: "reach", display: "none" }, this.stem, this.halo, this.knob);
  private at: ScreenPoint | undefined; // of the knob
  private dragged: ScreenPoint | undefined;
  private isHovered = false;

  constructor(
    private readonly context: ToolContext,
    private readonly region: Preview,
    private readonly isBusy: () => boolean,
    private readonly gizmo: { readonly size: number; readonly shift: ScreenPoint },
  ) {
    context.viewport.overlay.prepend(this.element);
    context.viewport.onFrame.add(() => this.draw());
    effect(() => this.light(context.editor.tools.reachFor.value));
  }

  /** The screen points that must stay free of bars. */
  get grips(): readonly ScreenPoint[] {
    return this.at === undefined ? [] : [this.at];
  }

  /** Returns whether a press at this point takes the knob. */
  hover(screenPoint: ScreenPoint, toleranceFactor = 1): boolean {
    const isHovered = this.at !== undefined && distanceToSegment(screenPoint, this.at, this.at) <= 12 * toleranceFactor;
    if (isHovered !== this.isHovered) this.context.viewport.requestRender();
    this.isHovered = isHovered;
    return isHovered;
  }

  press({ screenPoint: first }: Pointer): Stroke | undefined {
    const handle = this.context.control.active;
    if (handle?.reach === undefined || this.at === undefined) return undefined;
    const { reachFor } = this.context.editor.tools;
    const centre = this.centreOf(handle);
    const c = this.drawnAt(centre);
    const farFrom = ({ x, y }: ScreenPoint) => Math.hypot(x - c.x, y - c.y);
    const perPixel = this.context.camera.worldPerPixel(centre);
    const follow = ({ screenPoint }: Pointer) => {
      const reach = (handle.reach ?? 0) + (farFrom(screenPoint) - farFrom(first)) * perPixel;
      this.dragged = screenPoint;
      reachFor.value = { handle: handle.name, reach: Math.max(0.01 * this.diagonal, Math.min(reach, this.diagonal)) };
      this.say(reachFor.value.reach, screenPoint);
    };
    return {
      move: follow,
      end: (pointer) => {
        follow(pointer);
        void this.set();
      },
      cancel: () => this.stop(),
    };
  }

  private async set(): Promise<void> {
    const { value: asked } = this.context.editor.tools.reachFor;
    this.context.status.clear();
    if (asked !== null) await this.context.editor.ask({ do: "reach", handle: asked.handle, reach: asked.reach });
    this.stop();
  }

  private stop(): void {
    this.dragged = undefined;
    this.context.editor.tools.reachFor.value = null;
    this.context.status.clear();
    this.context.viewport.requestRender();
  }

  private get diagonal(): number {
    return this.context.editor.state.value?.model.diagonal ?? 1;
  }

  private say(reach: number, screenPoint: ScreenPoint): void {
    const unit = this.context.viewport.settings.unit.value;
    this.context.status.say(`Reach  ${reach.toPrecision(3)}${unit === "none" ? "" : ` ${unit}`}`, screenPoint);
  }

  // Highlights the vertices within the reach. Shows nothing for meshes of more than `mostVertices` vertices, for which
  // the search takes too long.
  private light(asked: { handle: string; reach: number } | null): void {
    this.context.viewport.requestRender();
    const surface = this.context.viewport.main;
    const handle = this.context.control.active;
    if (asked === null || handle?.name !== asked.handle || surface === undefined || surface.vertexCount > mostVertices)
      return this.region.hide();
    const inside = this.context.graphs.of(surface)?.within(handle.vertices, asked.reach, mostVertices);
    if (inside !== undefined) this.region.show(surface, inside.keys());
  }

  // Returns the current centre of the handle.
  private centreOf({ placement, defaultPivot }: ActiveHandle): Vector3 {
    if (placement.kind === "affine" && placement.course !== undefined) return centreOf(placement);
    return defaultPivot.clone().applyMatrix4(matrixOf(placement));
  }

  // Returns where the gizmo is drawn.
  private drawnAt(centre: Vector3): ScreenPoint {
    const { x, y } = this.context.camera.project(centre);
    return { x: x + this.gizmo.shift.x, y: y + this.gizmo.shift.y };
  }

  private draw(): void {
    const handle = this.context.control.active;
    const { before } = this.context.viewport.settings;
    const isShown = handle?.reach !== undefined && !this.isBusy() && !before.value;
    show(this.element, isShown);
    this.at = undefined;
    if (!isShown) return;
    const centre = this.centreOf(handle);
    if (this.context.camera.project(centre).behind) return show(this.element, false);
    const c = this.drawnAt(centre);
    const off = this.gizmo.size * knobPx * Math.SQRT1_2;
    this.at = this.dragged ?? this.inView({ x: c.x + off, y: c.y + off });
    const [o, knob] = onOverlay(this.context.viewport.overlay, [c, this.at]) as [ScreenPoint, ScreenPoint];
    const far = Math.hypot(knob.x - o.x, knob.y - o.y);
    const along = (px: number) => ({ x: o.x + ((knob.x - o.x) * px) / far, y: o.y + ((knob.y - o.y) * px) / far });
    set(this.stem, { d: far > stemPx ? linesThrough([along(far - stemPx), knob]) : "" });
    for (const circle of [this.halo, this.knob]) set(circle, { cx: knob.x, cy: knob.y });
    set(this.element, { class: `reach${this.isHovered || this.dragged !== undefined ? " hot" : ""}` });
  }

  // Keeps the knob within the page.
  private inView({ x, y }: ScreenPoint): ScreenPoint {
    const box = this.context.viewport.canvas.getBoundingClientRect();
    const within = (value: number, from: number, to: number) => Math.min(Math.max(value, from), to);
    return { x: within(x, box.left + 20, box.right - 20), y: within(y, box.top + 20, box.bottom - 40) };
  }
}
