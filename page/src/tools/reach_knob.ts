import { effect } from "@preact/signals";
import { Vector3 } from "three";
import type { Spot } from "./eye";
import { distanceToSegment } from "./gizmo_layout";
import type { ActiveHandle } from "./handle_control";
import { centreOf, matrixOf } from "./pose_math";
import type { Preview } from "./preview";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import type { Bench, Pointer, Stroke } from "./tool";

const knobPx = 150; // from the gizmo's middle, beyond its rings
const mostVertices = 300_000;
const stemPx = 18;

/**
 * How far the region around the active handle goes: a knob beside the gizmo, to drag away from it or towards it. What is
 * then reached, along edges as the engine measures it, lights up on the surface, also while the panel's slider moves.
 */
export class ReachKnob {
  private readonly stem = svg("path", { class: "reach-stem" });
  private readonly halo = svg("circle", { class: "reach-halo", r: 8 });
  private readonly knob = svg("circle", { class: "reach-knob", r: 6 });
  private readonly element = svg("g", { class: "reach", display: "none" }, this.stem, this.halo, this.knob);
  private at: Spot | undefined; // of the knob
  private dragged: Spot | undefined;
  private isHot = false;

  constructor(
    private readonly bench: Bench,
    private readonly region: Preview,
    private readonly isBusy: () => boolean,
  ) {
    bench.viewport.overlay.prepend(this.element);
    bench.viewport.onFrame.add(() => this.draw());
    effect(() => this.light(bench.editor.tools.reachFor.value));
  }

  /** Whether a press here takes the knob. */
  hover(spot: Spot, generosity = 1): boolean {
    const isHot = this.at !== undefined && distanceToSegment(spot, this.at, this.at) <= 12 * generosity;
    if (isHot !== this.isHot) this.bench.viewport.requestRender();
    this.isHot = isHot;
    return isHot;
  }

  press({ spot: first }: Pointer): Stroke | undefined {
    const handle = this.bench.control.active;
    if (handle?.reach === undefined || this.at === undefined) return undefined;
    const { reachFor } = this.bench.editor.tools;
    const centre = this.centreOf(handle);
    const c = this.bench.eye.project(centre);
    const farFrom = ({ x, y }: Spot) => Math.hypot(x - c.x, y - c.y);
    const perPixel = this.bench.eye.worldPerPixel(centre);
    const follow = ({ spot }: Pointer) => {
      const reach = (handle.reach ?? 0) + (farFrom(spot) - farFrom(first)) * perPixel;
      this.dragged = spot;
      reachFor.value = { handle: handle.name, reach: Math.max(0.01 * this.diagonal, Math.min(reach, this.diagonal)) };
      this.say(reachFor.value.reach, spot);
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
    const { value: asked } = this.bench.editor.tools.reachFor;
    this.bench.status.clear();
    if (asked !== null) await this.bench.editor.ask({ do: "reach", handle: asked.handle, reach: asked.reach });
    this.stop();
  }

  private stop(): void {
    this.dragged = undefined;
    this.bench.editor.tools.reachFor.value = null;
    this.bench.status.clear();
    this.bench.viewport.requestRender();
  }

  private get diagonal(): number {
    return this.bench.editor.state.value?.model.diagonal ?? 1;
  }

  private say(reach: number, spot: Spot): void {
    const unit = this.bench.viewport.settings.unit.value;
    this.bench.status.say(`Reach  ${reach.toPrecision(3)}${unit === "none" ? "" : ` ${unit}`}`, spot);
  }

  // What would be reached; nothing where that would take the page too long to find.
  private light(asked: { handle: string; reach: number } | null): void {
    this.bench.viewport.requestRender();
    const surface = this.bench.viewport.main;
    const handle = this.bench.control.active;
    if (asked === null || handle?.name !== asked.handle || surface === undefined || surface.vertexCount > mostVertices)
      return this.region.hide();
    const inside = this.bench.graphs.of(surface)?.within(handle.vertices, asked.reach, mostVertices);
    if (inside !== undefined) this.region.show(surface, inside.keys());
  }

  // Where the handle is now.
  private centreOf({ placement, defaultPivot }: ActiveHandle): Vector3 {
    if (placement.kind === "affine" && placement.course !== undefined) return centreOf(placement);
    return defaultPivot.clone().applyMatrix4(matrixOf(placement));
  }

  private draw(): void {
    const handle = this.bench.control.active;
    const { before } = this.bench.viewport.settings;
    const isShown = handle?.reach !== undefined && !this.isBusy() && !before.value;
    show(this.element, isShown);
    this.at = undefined;
    if (!isShown) return;
    const c = this.bench.eye.project(this.centreOf(handle));
    if (c.behind) return show(this.element, false);
    const off = knobPx * Math.SQRT1_2;
    this.at = this.dragged ?? this.inView({ x: c.x + off, y: c.y + off });
    const [o, knob] = onOverlay(this.bench.viewport.overlay, [c, this.at]) as [Spot, Spot];
    const far = Math.hypot(knob.x - o.x, knob.y - o.y);
    const along = (px: number) => ({ x: o.x + ((knob.x - o.x) * px) / far, y: o.y + ((knob.y - o.y) * px) / far });
    set(this.stem, { d: far > stemPx ? linesThrough([along(far - stemPx), knob]) : "" });
    for (const circle of [this.halo, this.knob]) set(circle, { cx: knob.x, cy: knob.y });
    set(this.element, { class: `reach${this.isHot || this.dragged !== undefined ? " hot" : ""}` });
  }

  // The knob stays on the page.
  private inView({ x, y }: Spot): Spot {
    const box = this.bench.viewport.canvas.getBoundingClientRect();
    const within = (value: number, from: number, to: number) => Math.min(Math.max(value, from), to);
    return { x: within(x, box.left + 20, box.right - 20), y: within(y, box.top + 20, box.bottom - 40) };
  }
}
