import type { Hit } from "../view/picking/picking";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import { BrushRing, BrushStroke } from "./select_tools";
import { clickStroke, type ToolContext, type Pointer, type Stroke, type Tool } from "./tool";
import type { Surface } from "../view/surface/surface";
import type { ScreenPoint } from "./screen_camera";

/** Makes a click on a handle activate it, with every tool. */
function pickUp(context: ToolContext, hit: Hit): Stroke | undefined {
  const name = context.control.handleAt(hit.surface, hit.vertex);
  if (name === undefined || name === context.editor.tools.activeHandle.value) return undefined;
  return clickStroke(() => context.control.activate(name));
}

/** Names the handle that a click would activate. */
function sayHandle(context: ToolContext, { screenPoint }: Pointer, hit: Hit | undefined): boolean {
  const name = hit === undefined ? undefined : context.control.handleAt(hit.surface, hit.vertex);
  if (name === undefined || name === context.editor.tools.activeHandle.value) context.status.clear();
  else context.status.say(name, screenPoint);
  return name !== undefined;
}

/** The default tool: a drag turns the view, a click on a handle activates it. */
export class NavigateTool implements Tool {
  readonly cursor = "grab";
  constructor(private readonly context: ToolContext) {}

  hover(pointer: Pointer, hit: Hit | undefined): void {
    sayHandle(this.context, pointer, hit);
  }
  leave(): void {
    this.context.status.clear();
  }
  press(_pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    return hit === undefined ? undefined : pickUp(this.context, hit);
  }
}

/** Paints the vertices of a handle. At the end of the stroke the handle and its gizmo appear. */
export class PaintTool implements Tool {
  readonly cursor = "crosshair";
  private readonly ring: BrushRing;

  constructor(private readonly context: ToolContext) {
    this.ring = new BrushRing(context);
  }

  hover(pointer: Pointer, hit: Hit | undefined): void {
    if (sayHandle(this.context, pointer, hit)) this.ring.hide();
    else this.ring.show(pointer);
  }
  leave(): void {
    this.ring.hide();
    this.context.status.clear();
    this.context.preview.hide();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    if (hit === undefined) return undefined;
    if (this.context.control.handleAt(hit.surface, hit.vertex) !== undefined) return pickUp(this.context, hit);
    const { control, preview } = this.context;
    const { surface } = hit;
    const stroke = new BrushStroke(this.context, surface, pointer.screenPoint);
    const paint = (at: Pointer) => {
      this.ring.show(at);
      if (stroke.to(at).length > 0) preview.show(surface, stroke.painted);
    };
    paint(pointer);
    return {
      followsPath: true,
      move: paint,
      end: () => {
        this.ring.hide();
        void control.paint(surface, stroke.vertices).finally(() => preview.hide());
      },
      cancel: () => preview.hide(),
    };
  }
}

/** Makes a handle of one vertex, by a click. */
export class VertexTool implements Tool {
  readonly cursor = "pointer";
  private readonly dot = svg("circle", { class: "vertex-dot", r: 5, display: "none" });

  constructor(private readonly context: ToolContext) {
    context.viewport.overlay.append(this.dot);
  }

  hover(pointer: Pointer, hit: Hit | undefined): void {
    const isHeld = sayHandle(this.context, pointer, hit);
    show(this.dot, hit !== undefined && !isHeld);
    if (hit === undefined) return;
    const { viewport } = this.context;
    const [at] = onOverlay(viewport.overlay, [viewport.project(hit.surface.positionOf(hit.vertex))]) as [ScreenPoint];
    set(this.dot, { cx: at.x, cy: at.y });
  }
  leave(): void {
    show(this.dot, false);
    this.context.status.clear();
  }

  press(_pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    if (hit === undefined) return undefined;
    const { control } = this.context;
    if (control.handleAt(hit.surface, hit.vertex) !== undefined) return pickUp(this.context, hit);
    return clickStroke(() => {
      this.leave();
      void control.paint(hit.surface, Uint32Array.of(hit.vertex));
    });
  }
}

/** Makes a handle along edges: clicks give its points, joined by shortest paths. */
export class CurveTool implements Tool {
  readonly cursor = "crosshair";
  private surface: Surface | undefined;
  private clicked: number[] = [];
  private path: number[] = []; // through the clicked vertices
  private ahead: Uint32Array = new Uint32Array(); // to the vertex under the pointer
  private closes = false;
  private readonly line = svg("path", { class: "curve", display: "none" });
  private readonly rest = svg("path", { class: "curve ahead", display: "none" });
  private readonly dots = svg("g", { class: "curve-dots" });

  constructor(private readonly context: ToolContext) {
    context.viewport.overlay.append(this.line, this.rest, this.dots);
    context.viewport.onFrame.add(() => this.draw());
  }

  hover({ screenPoint }: Pointer, hit: Hit | undefined): void {
    const { status, graphs } = this.context;
    const last = this.clicked[this.clicked.length - 1];
    this.closes = this.isAtFirst(screenPoint);
    const isSame = hit?.surface === (this.surface ?? hit?.surface);
    const to = this.closes ? this.clicked[0] : isSame ? hit?.vertex : undefined;
    const surface = this.surface ?? hit?.surface;
    const graph = surface === undefined ? undefined : graphs.of(surface);
    const path = to === undefined || last === undefined ? undefined : graph?.path(last, to);
    this.ahead = path ?? Uint32Array.of(...(to === undefined ? [] : [to]));
    if (this.closes) status.say("Click to close the curve", screenPoint);
    else if (this.clicked.length > 1) status.say("Enter or a double-click finishes the curve", screenPoint);
    else status.clear();
    this.context.viewport.requestRender();
  }
  leave(): void {
    this.ahead = new Uint32Array();
    this.context.status.clear();
    this.context.viewport.requestRender();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    if (hit === undefined && !this.isAtFirst(pointer.screenPoint)) return undefined;
    return clickStroke(() => this.click(pointer, hit));
  }

  /** Ends the curve and makes the handle. */
  confirm(): boolean {
    if (this.path.length < 2) return false;
    this.finish(false);
    return true;
  }
  /** Discards all clicked points. Returns whether there were any. */
  escape(): boolean {
    if (this.clicked.length === 0) return false;
    this.clear();
    return true;
  }

  private click(pointer: Pointer, hit: Hit | undefined): void {
    this.hover(pointer, hit);
    if (this.closes) return this.finish(true);
    if (hit === undefined) return;
    const last = this.clicked[this.clicked.length - 1];
    if (hit.vertex === last) return void this.confirm(); // the second click of a double click
    if (last !== undefined && this.ahead[0] !== last) return; // there is no path
    this.surface = hit.surface;
    this.clicked.push(hit.vertex);
    this.path.push(...(last === undefined ? [hit.vertex] : this.ahead.slice(1)));
    this.ahead = new Uint32Array();
    this.context.viewport.requestRender();
  }

  private finish(closed: boolean): void {
    const { surface } = this;
    if (surface === undefined) return;
    const whole = closed ? [...this.path, ...this.ahead.slice(1, -1)] : this.path;
    const path = Uint32Array.from(new Set(whole));
    this.clear();
    void this.context.control.addCurve(surface, path, closed);
  }

  private clear(): void {
    this.clicked = [];
    this.path = [];
    this.surface = undefined;
    this.leave();
  }

  private isAtFirst(screenPoint: ScreenPoint): boolean {
    const [first] = this.clicked;
    if (first === undefined || this.clicked.length < 3 || this.surface === undefined) return false;
    const at = this.context.viewport.project(this.surface.positionOf(first));
    return Math.hypot(at.x - screenPoint.x, at.y - screenPoint.y) < 12;
  }

  private draw(): void {
    const surface = this.surface ?? this.context.viewport.main;
    const isShown = surface !== undefined && (this.clicked.length > 0 || this.ahead.length > 0);
    for (const element of [this.line, this.rest, this.dots]) show(element, isShown);
    if (surface === undefined || !isShown) return;
    const { viewport } = this.context;
    const screenPoints = (vertices: Iterable<number>) =>
      onOverlay(viewport.overlay, Array.from(vertices, (v) => viewport.project(surface.positionOf(v))));
    set(this.line, { d: linesThrough(screenPoints(this.path)) });
    set(this.rest, { d: linesThrough(screenPoints(this.ahead)) });
    const ends = screenPoints([...this.clicked, ...this.ahead.slice(-1)]);
    this.dots.replaceChildren(...ends.map(({ x, y }) => svg("circle", { cx: x, cy: y, r: 4.5 })));
  }
}
