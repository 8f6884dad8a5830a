import { effect } from "@preact/signals";
import type { GraftFields } from "../../app/graft/graft_step";
import { matrixOfRows, type GraftView } from "../../view/graft/graft_view";
import { distanceToSegment } from "../gizmo_layout";
import type { ScreenPoint } from "../screen_camera";
import { linesThrough, onOverlay, set, show, svg } from "../svg";
import type { Pointer, Stroke, ToolContext } from "../tool";
import { baseCorners, baseFrame, raised, tilted, type BaseFrame } from "./base_plane";

type Grip = "height" | "tilt";

const stemPx = 56; // from the plane to the grip of its height
const nearPx = 12; // of a press; twice as far for fingers

/**
 * Shows the plane at which a dropped part is cut open, as an outline in the view. One grip, beside the plane along its
 * normal, moves it up and down; the other one, at its rim, tilts it. During the drop the outline is shown alone, as the
 * pointer carries the part.
 */
export class BaseGrip {
  private readonly outline = svg("path", { class: "base-outline" });
  private readonly stem = svg("path", { class: "base-stem" });
  private readonly knobs: Record<Grip, SVGGElement> = { height: knob("height"), tilt: knob("tilt") };
  private readonly element = svg("g", { class: "base-grip", display: "none" }, this.outline, this.stem, this.knobs.tilt, this.knobs.height);
  private at: Partial<Record<Grip, ScreenPoint>> = {};
  private hot: Grip | undefined;
  private dragged: BaseFrame | undefined;
  private last: { readonly mesh: number; readonly frame: BaseFrame } | undefined; // stays where a plane is refused

  constructor(
    private readonly context: ToolContext,
    private readonly view: GraftView,
  ) {
    context.viewport.overlay.prepend(this.element);
    context.viewport.onFrame.add(() => this.draw());
    effect(() => {
      const { mode, report, step, tool, transform } = this.graft;
      void [mode.value, report.value, step.value, tool.value, transform.value];
      context.viewport.requestRender();
    });
  }

  private get graft() {
    return this.context.editor.graft;
  }

  /** The screen points that must stay free of bars. */
  get grips(): readonly ScreenPoint[] {
    return Object.values(this.at);
  }

  /** Returns whether a press at this point takes a grip. */
  hover(screenPoint: ScreenPoint, toleranceFactor = 1): boolean {
    const hot = this.gripAt(screenPoint, toleranceFactor);
    if (hot !== this.hot) this.context.viewport.requestRender();
    this.hot = hot;
    return hot !== undefined;
  }

  /** Names the grip at a point, for those who do not see it. */
  wordsAt(screenPoint: ScreenPoint): string | undefined {
    const grip = this.gripAt(screenPoint, 1);
    return grip === undefined ? undefined : grip === "height" ? "Grip: height of the base." : "Grip: tilt of the base.";
  }

  press({ screenPoint: first }: Pointer): Stroke | undefined {
    const frame = this.frame();
    const { hot } = this;
    if (frame === undefined || hot === undefined) return undefined;
    const follow = ({ screenPoint }: Pointer) => {
      const by = this.alongNormal(frame, first, screenPoint);
      const moved = hot === "height" ? raised(frame, by) : tilted(frame, by);
      this.dragged = moved;
      const { height, tiltDeg: tilt_deg, tiltAxis: tilt_axis } = moved;
      this.graft.drag(this.fieldsWith(hot === "height" ? { height } : { tilt_deg, tilt_axis }));
      this.context.status.say(hot === "height" ? `Base  ${height.toPrecision(3)}` : `Base tilt  ${tilt_deg}°`, screenPoint);
    };
    return {
      move: follow,
      end: () => {
        if (this.dragged !== undefined) void this.graft.keepDragged();
        this.stop();
      },
      cancel: () => {
        if (this.dragged !== undefined) void this.graft.forgetDragged();
        this.stop();
      },
    };
  }

  private stop(): void {
    this.dragged = undefined;
    this.context.status.clear();
    this.context.viewport.requestRender();
  }

  private gripAt(screenPoint: ScreenPoint, toleranceFactor: number): Grip | undefined {
    const farFrom = (grip: Grip) => {
      const at = this.at[grip];
      return at === undefined ? Infinity : distanceToSegment(screenPoint, at, at);
    };
    const nearest = farFrom("tilt") < farFrom("height") ? "tilt" : "height";
    return farFrom(nearest) <= nearPx * toleranceFactor ? nearest : undefined;
  }

  private fieldsWith(base: object): GraftFields {
    const { base: before, ...place } = this.graft.step.value?.at ?? {};
    return { at: { ...place, base: { ...before, ...base } } as GraftFields["at"] };
  }

  // Returns by how much the pointer has moved along the normal, in world units.
  private alongNormal({ centre, normal, radius }: BaseFrame, first: ScreenPoint, now: ScreenPoint): number {
    const { camera } = this.context;
    const from = camera.project(centre);
    const to = camera.project(centre.clone().addScaledVector(normal, radius));
    const [dx, dy] = [(to.x - from.x) / radius, (to.y - from.y) / radius];
    const perWorld = dx * dx + dy * dy;
    const pixel = camera.worldPerPixel(centre);
    if (perWorld * pixel * pixel < 0.04) return (first.y - now.y) * pixel; // the normal points at the camera
    return ((now.x - first.x) * dx + (now.y - first.y) * dy) / perWorld;
  }

  // Returns the plane where it is shown; undefined if no closed part is dropped.
  private frame(): BaseFrame | undefined {
    const { mode, tool, report, step } = this.graft;
    const { base, transform } = report.value ?? {};
    const isShown = mode.value === "graft" && (tool.value === "loops" || tool.value === "drop") && this.graft.arrangement.value !== "apart";
    const surface = this.context.viewport.surfaceOf(this.graft.source.value?.mesh ?? -1);
    const at = step.value?.at;
    if (!isShown || at === undefined || surface === undefined) return undefined;
    if (base === undefined || transform === undefined)
      return report.value?.error !== undefined && this.last?.mesh === surface.id ? this.last.frame : undefined;
    const toWorld = this.view.targetMatrixWorld.clone().multiply(matrixOfRows(transform));
    const frame = baseFrame(base, at.base ?? {}, toWorld, surface.box.diagonal);
    this.last = { mesh: surface.id, frame };
    return frame;
  }

  private draw(): void {
    const frame = this.dragged ?? this.frame();
    const isShown = frame !== undefined && !this.context.viewport.settings.before.value;
    show(this.element, isShown);
    this.at = {};
    if (!isShown) return;
    const { camera, viewport } = this.context;
    const centre = camera.project(frame.centre);
    if (centre.behind) return show(this.element, false);
    const corners = baseCorners(frame).map((corner) => camera.project(corner));
    set(this.outline, { d: linesThrough(onOverlay(viewport.overlay, corners), true) });
    const hasGrips = this.graft.tool.value === "loops";
    for (const one of [this.stem, ...Object.values(this.knobs)]) show(one, hasGrips);
    if (!hasGrips) return;
    const rimAt = (by: number) => frame.centre.clone().addScaledVector(frame.towardsTilt, by * frame.radius);
    const side = rimAt(-1); // beside the part
    const up = side.clone().addScaledVector(frame.normal, stemPx * camera.worldPerPixel(frame.centre));
    const points = { foot: camera.project(side), height: camera.project(up), tilt: camera.project(rimAt(1)) };
    this.at = { height: points.height, tilt: points.tilt };
    const [foot, top, rim] = onOverlay(viewport.overlay, [points.foot, points.height, points.tilt]) as [ScreenPoint, ScreenPoint, ScreenPoint];
    set(this.stem, { d: linesThrough([foot, top]) });
    this.place("height", top);
    this.place("tilt", rim);
  }

  private place(grip: Grip, { x, y }: ScreenPoint): void {
    set(this.knobs[grip], { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, class: `base-knob ${grip}${this.hot === grip ? " hot" : ""}` });
  }
}

function knob(grip: Grip): SVGGElement {
  const sign = grip === "height" ? "M0 -3.500V3.500M-2.500 -1.500L0 -4L2.500 -1.500M-2.500 1.500L0 4L2.500 1.500" : "M-3.500 1.500A4 4 0 0 1 3.500 1.500M3.500 -1.500V1.500H0.500";
  return svg("g", { class: `base-knob ${grip}` }, svg("circle", { class: "halo", r: 9 }), svg("circle", { class: "disc", r: 7.5 }), svg("path", { d: sign }));
}
