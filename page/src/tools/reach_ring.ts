import { Vector3 } from "three";
import type { Spot } from "./eye";
import { distanceToSegment } from "./gizmo_layout";
import { centreOf, matrixOf } from "./pose_math";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import { type Bench, type Pointer, type Stroke } from "./tool";
import type { Preview } from "./preview";
import type { ActiveHandle } from "./handle_control";

/** How far the region around the active handle goes: a ring with a knob to drag, beside the gizmo. */
export class ReachRing {
  private readonly ring = svg("circle", { class: "reach-ring" });
  private readonly stem = svg("path", { class: "reach-stem" });
  private readonly halo = svg("circle", { class: "reach-halo", r: 8 });
  private readonly knob = svg("circle", { class: "reach-knob", r: 6 });
  private readonly element = svg("g", { class: "reach", display: "none" }, this.ring, this.stem, this.halo, this.knob);
  private at: Spot | undefined; // of the knob
  private dragged: number | undefined;
  private isHot = false;

  constructor(
    private readonly bench: Bench,
    private readonly region: Preview,
    private readonly isBusy: () => boolean,
  ) {
    bench.viewport.overlay.prepend(this.element);
    bench.viewport.onFrame.add(() => this.draw());
  }

  /** Whether a press here takes the knob. */
  hover(spot: Spot, generosity = 1): boolean {
    const isHot = this.at !== undefined && distanceToSegment(spot, this.at, this.at) <= 12 * generosity;
    if (isHot !== this.isHot) this.bench.viewport.requestRender();
    this.isHot = isHot;
    return isHot;
  }

  press({ spot }: Pointer): Stroke | undefined {
    const handle = this.bench.control.active;
    if (handle?.reach === undefined || this.at === undefined) return undefined;
    const { centre, size } = this.extentOf(handle);
    const c = this.bench.eye.project(centre);
    const from = Math.hypot(spot.x - c.x, spot.y - c.y);
    const start = handle.reach;
    const follow = ({ spot: to }: Pointer) => {
      const far = Math.hypot(to.x - c.x, to.y - c.y);
      const reach = start + (far - from) * this.bench.eye.worldPerPixel(centre);
      this.dragged = Math.max(0.02 * size, 0.002 * this.diagonal, Math.min(reach, this.diagonal));
      this.preview(handle, this.dragged, to);
    };
    return {
      move: follow,
      end: (pointer) => {
        follow(pointer);
        void this.set(handle.name, this.dragged ?? start);
      },
      cancel: () => this.stop(),
    };
  }

  private async set(name: string, reach: number): Promise<void> {
    this.bench.status.clear();
    await this.bench.editor.ask({ do: "reach", handle: name, reach });
    this.stop();
  }

  private stop(): void {
    this.dragged = undefined;
    this.region.hide();
    this.bench.status.clear();
    this.bench.viewport.requestRender();
  }

  private get diagonal(): number {
    return this.bench.editor.state.value?.model.diagonal ?? 1;
  }

  private preview(handle: ActiveHandle, reach: number, spot: Spot): void {
    const surface = this.bench.viewport.main;
    const unit = this.bench.viewport.settings.unit.value;
    this.bench.status.say(`Reach  ${reach.toPrecision(3)}${unit === "none" ? "" : ` ${unit}`}`, spot);
    this.bench.viewport.requestRender();
    if (surface === undefined || surface.vertexCount > 300_000) return;
    const inside = this.bench.graphs.of(surface)?.within(handle.vertices, reach);
    if (inside !== undefined) this.region.show(surface, inside.keys());
  }

  // Where the handle is now, and how far its vertices lie from there.
  private extentOf(handle: ActiveHandle): { centre: Vector3; size: number } {
    const surface = this.bench.viewport.main;
    const { placement } = handle;
    const map = matrixOf(placement);
    if (placement.kind === "affine" && placement.course !== undefined) {
      const centre = centreOf(placement);
      const far = placement.course.map((point) => point.clone().applyMatrix4(map).distanceTo(centre));
      return { centre, size: Math.max(...far) };
    }
    const centre = handle.defaultPivot.clone().applyMatrix4(map);
    let size = 0;
    const place = new Vector3();
    if (surface !== undefined)
      for (const v of handle.vertices) {
        place.fromArray(surface.rest, 3 * v).add(surface.object.position).applyMatrix4(map);
        size = Math.max(size, place.distanceTo(centre));
      }
    return { centre, size };
  }

  private draw(): void {
    const handle = this.bench.control.active;
    const reach = this.dragged ?? handle?.reach;
    const { before } = this.bench.viewport.settings;
    const isShown = handle !== undefined && reach !== undefined && !this.isBusy() && !before.value;
    show(this.element, isShown);
    this.at = undefined;
    if (!isShown) return;
    const { centre, size } = this.extentOf(handle);
    const c = this.bench.eye.project(centre);
    if (c.behind) return show(this.element, false);
    const radius = (size + reach) / this.bench.eye.worldPerPixel(centre);
    // Where the ring is within the gizmo, the knob stands off it, and further in steps with it.
    const off = Math.max(radius, leastKnobPx + 0.15 * radius) * Math.SQRT1_2;
    this.at = this.inView({ x: c.x + off, y: c.y + off });
    const [o, knob] = onOverlay(this.bench.viewport.overlay, [c, this.at]) as [Spot, Spot];
    const on = { x: o.x + radius * Math.SQRT1_2, y: o.y + radius * Math.SQRT1_2 };
    set(this.ring, { cx: o.x, cy: o.y, r: radius });
    set(this.stem, { d: linesThrough([on, knob]) });
    for (const circle of [this.halo, this.knob]) set(circle, { cx: knob.x, cy: knob.y });
    set(this.element, { class: `reach${this.isHot || this.dragged !== undefined ? " hot" : ""}` });
  }

  // A large ring's knob stays on the page.
  private inView({ x, y }: Spot): Spot {
    const box = this.bench.viewport.canvas.getBoundingClientRect();
    const within = (value: number, from: number, to: number) => Math.min(Math.max(value, from), to);
    return { x: within(x, box.left + 20, box.right - 20), y: within(y, box.top + 20, box.bottom - 40) };
  }
}

const leastKnobPx = 150;
