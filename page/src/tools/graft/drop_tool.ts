import type { Graft } from "../../app/graft/graft";
import type { GraftFields } from "../../app/graft/graft_step";
import { pointerKind } from "../../app/pointer_kind";
import { formatNumber } from "../../app/units";
import type { GraftView } from "../../view/graft/graft_view";
import type { Hit } from "../../view/picking/picking";
import { raycastSurface } from "../../view/picking/picking";
import type { ScreenPoint } from "../screen_camera";
import type { ToolContext, Pointer, Stroke, Tool } from "../tool";

/** The point where a part is dropped, and its spin and scale. */
interface Drop {
  point: [number, number, number];
  spinDeg: number;
  size: number | undefined;
  /** Where a closed part is cut open, above its lowest point. */
  baseHeight: number | undefined;
  /** By how much the plane of that cut is tilted. */
  baseTiltDeg: number;
}

const mostStarts = 400; // places that are tried for a drop by keys
const mostTiltDeg = 60; // beyond, the plane hardly cuts the part

/**
 * Drops a part: it follows the pointer over the surface, spins and scales, and is grafted where it is released. The
 * height at which a closed part is cut open changes by the wheel, too.
 */
export class DropTool implements Tool {
  readonly cursor = "copy";
  private drop: Drop | undefined;
  private screenPoint: ScreenPoint | undefined;

  constructor(
    private readonly context: ToolContext,
    private readonly view: GraftView,
  ) {}

  private get graft(): Graft {
    return this.context.editor.graft;
  }

  hover({ screenPoint }: Pointer, _hit: Hit | undefined): void {
    this.screenPoint = screenPoint;
    const point = this.pointUnder(screenPoint);
    if (point === undefined) {
      this.context.status.say("Point at the surface", screenPoint);
      return;
    }
    this.drop = { spinDeg: 0, size: undefined, baseHeight: undefined, baseTiltDeg: 0, ...this.drop, point };
    this.show();
  }

  leave(): void {
    this.context.status.clear();
  }

  /** A click grafts the part at the pointer. */
  press(pointer: Pointer): Stroke | undefined {
    this.hover(pointer, undefined);
    if (this.pointUnder(pointer.screenPoint) === undefined) return undefined;
    return {
      move: (at) => this.hover(at, undefined),
      end: (at) => {
        this.hover(at, undefined);
        if (this.isOverTarget(at.screenPoint)) void this.finish();
      },
      cancel: () => this.cancel(),
      endsByOneKey: true,
    };
  }

  /** Grafts the part where it is shown, if the pointer is over the surface. */
  confirm(): boolean {
    if (this.drop === undefined || this.graft.dropped.value === null) return false;
    if (this.screenPoint !== undefined && this.isOverTarget(this.screenPoint)) void this.finish();
    else this.context.editor.announce("Beside the model. Move the part back onto it, or press Escape.");
    return true;
  }

  /** Returns a point of the page over the target, near its middle; undefined if none is in the view. */
  startPoint(): ScreenPoint | undefined {
    const { viewport } = this.context;
    const mesh = this.targetMesh();
    const surface = viewport.surfaceOf(mesh);
    if (surface === undefined) return undefined;
    const middle = viewport.project(surface.sphere().center.applyMatrix4(this.view.targetMatrixWorld));
    const step = Math.max(1, Math.floor(surface.vertexCount / mostStarts));
    const points: ScreenPoint[] = [middle];
    for (let v = 0; v < surface.vertexCount; v += step) points.push(viewport.project(surface.positionOf(v).applyMatrix4(this.view.targetMatrixWorld)));
    const far = ({ x, y }: ScreenPoint) => Math.hypot(x - middle.x, y - middle.y);
    const isFree = ({ x, y }: ScreenPoint) => document.elementFromPoint(x, y) === viewport.canvas;
    return points.sort((a, b) => far(a) - far(b)).find((point) => isFree(point) && this.isOverTarget(point));
  }

  wordsAt(screenPoint: ScreenPoint): string {
    const { name = "The part" } = this.graft.dropped.value ?? {};
    const point = this.pointUnder(screenPoint);
    if (point === undefined) return "Beside the model.";
    const target = this.graft.byMesh(this.targetMesh())?.name ?? "the model";
    return `${name} on ${target}, at ${point.map((x) => formatNumber(x, 3)).join(", ")}.`;
  }

  wheel(event: WheelEvent): boolean {
    if (this.drop === undefined) return false;
    const step = Math.max(-3, Math.min(3, (event.deltaY || event.deltaX) / 100));
    if (event.altKey && event.shiftKey) this.tiltBase(-5 * step);
    else if (event.altKey) this.raiseBase(Math.exp(-0.1 * step));
    else if (event.shiftKey || event.ctrlKey) this.scale(Math.exp(-0.1 * step));
    else this.spin(7.5 * step);
    return true;
  }

  takeKey({ key, shiftKey }: KeyboardEvent): boolean {
    if (this.drop === undefined) return false;
    const back = shiftKey ? -1 : 1;
    if (key.toLowerCase() === "r") this.spin(15 * back);
    else if (key.toLowerCase() === "s") this.scale(1.1 ** back);
    else if (key.toLowerCase() === "b") this.raiseBase(1.1 ** back);
    else if (key.toLowerCase() === "t") this.tiltBase(5 * back);
    else return false;
    this.context.editor.announce(`${this.words()}.`);
    return true;
  }

  escape(): boolean {
    this.cancel();
    return true;
  }

  private spin(byDeg: number): void {
    if (this.drop === undefined) return;
    const turned = this.drop.spinDeg + byDeg;
    this.drop.spinDeg = turned - 360 * Math.round(turned / 360);
    this.show();
  }
  private scale(by: number): void {
    if (this.drop === undefined) return;
    const now = this.drop.size ?? this.graft.report.value?.size ?? 1;
    this.drop.size = Number((now * by).toPrecision(4));
    this.show();
  }

  // The height is known once a preview has come.
  private raiseBase(by: number): void {
    if (this.drop === undefined) return;
    const now = this.drop.baseHeight ?? this.graft.report.value?.base?.height;
    if (now === undefined) return;
    this.drop.baseHeight = Number((now * by).toPrecision(4));
    this.show();
  }

  // Open parts have no base to cut.
  private tiltBase(byDeg: number): void {
    if (this.drop === undefined || this.graft.byName(this.graft.dropped.value?.name)?.loops !== 0) return;
    this.drop.baseTiltDeg = Math.max(-mostTiltDeg, Math.min(mostTiltDeg, this.drop.baseTiltDeg + byDeg));
    this.show();
  }

  private fields(): GraftFields | undefined {
    const { drop } = this;
    const source = this.graft.dropped.value?.name;
    if (drop === undefined || source === undefined) return undefined;
    const at = {
      point: drop.point,
      ...(drop.spinDeg === 0 ? {} : { spin_deg: drop.spinDeg }),
      ...baseOf(drop),
    };
    return { source, at, size: drop.size ?? null };
  }

  /** Describes how the part is turned, scaled and tilted. */
  private words(): string {
    const { spinDeg = 0, size, baseHeight, baseTiltDeg = 0 } = this.drop ?? {};
    return [
      `Spin ${spinDeg.toFixed(0)} degrees`,
      ...(size === undefined ? [] : [`size ${size.toPrecision(3)}`]),
      ...(baseHeight === undefined ? [] : [`base at ${baseHeight.toPrecision(3)}`]),
      ...(baseTiltDeg === 0 ? [] : [`base tilted ${baseTiltDeg.toFixed(0)} degrees`]),
    ].join(", ");
  }

  private show(): void {
    const fields = this.fields();
    if (fields === undefined || this.drop === undefined || this.screenPoint === undefined) return;
    this.graft.drag(fields);
    const size = this.drop.size === undefined ? "original size" : `× ${this.drop.size.toPrecision(3)}`;
    const isClosed = this.graft.byName(this.graft.dropped.value?.name)?.loops === 0;
    const found = this.drop.baseHeight ?? this.graft.report.value?.base?.height;
    const height = found === undefined ? "by itself" : `at ${found.toPrecision(3)}`;
    const tilt = this.drop.baseTiltDeg === 0 ? "" : `, tilted ${this.drop.baseTiltDeg.toFixed(0)}°`;
    const base = isClosed ? ` · cut open ${height}${tilt}` : "";
    const spin = `Spin ${this.drop.spinDeg.toFixed(0)}°`;
    this.context.status.say(
      pointerKind.value === "touch"
        ? `${spin} · ${size}${base} · lift the finger to graft${isClosed ? ", then drag the grips of its base" : ""}`
        : `${spin} (wheel, R) · ${size} (Shift+wheel, S)${base}${isClosed ? " (Alt+wheel, B; T tilts)" : ""} · Esc cancels`,
      this.screenPoint,
    );
  }

  /** Grafts the part at its current point. */
  async finish(): Promise<void> {
    const fields = this.fields();
    if (fields === undefined) return this.cancel();
    const { name = "The part" } = this.graft.dropped.value ?? {};
    const done = this.graft.endDrop(fields);
    this.end();
    await done;
    if (this.graft.isEdited.value) this.context.editor.announce(`${name} is on the surface. Ctrl and Enter accept the graft.`);
  }
  /** Cancels the drop and says why: the part was released off the surface. */
  async cancelMissed(): Promise<void> {
    const done = this.graft.cancelMissedDrop();
    this.end();
    await done;
  }
  cancel(): void {
    const { value: dropped } = this.graft.dropped;
    if (dropped !== null) {
      void this.graft.cancelDrop();
      this.context.editor.announce(`Cancelled: ${dropped.name} is not grafted.`);
    }
    this.end();
  }
  /** Returns whether the target's surface is under this point. */
  isOverTarget(screenPoint: ScreenPoint): boolean {
    return this.pointUnder(screenPoint) !== undefined;
  }
  private end(): void {
    this.drop = undefined;
    this.context.status.clear();
    if (this.graft.tool.value === "drop") this.graft.tool.value = "loops";
  }

  private targetMesh(): number {
    return this.graft.byName(this.graft.kept.value?.target ?? this.graft.model.value?.name)?.mesh ?? -1;
  }

  // Picks the target itself, which is hidden while the result is shown.
  private pointUnder({ x, y }: ScreenPoint): [number, number, number] | undefined {
    const { viewport } = this.context;
    const surface = viewport.surfaceOf(this.targetMesh());
    if (surface === undefined) return undefined;
    const ray = viewport.rayAt(x, y).applyMatrix4(this.view.targetMatrixWorld.clone().invert());
    const point = raycastSurface(surface, viewport.treeOf(surface), ray)?.point;
    return point === undefined ? undefined : [point.x, point.y, point.z];
  }
}

/** Returns the field `base` of the place of a drop, where the user has changed it. */
function baseOf({ baseHeight, baseTiltDeg }: Drop): { base?: { height?: number; tilt_deg?: number } } {
  if (baseHeight === undefined && baseTiltDeg === 0) return {};
  return {
    base: {
      ...(baseHeight === undefined ? {} : { height: baseHeight }),
      ...(baseTiltDeg === 0 ? {} : { tilt_deg: baseTiltDeg }),
    },
  };
}
