import { Vector3 } from "three";
import type { AskedSelection } from "../protocol";
import type { Hit } from "../view/picking/picking";
import type { Surface } from "../view/surface/surface";
import type { ScreenPoint } from "./screen_camera";
import { StrokePath } from "./stroke_path";
import { linesThrough, onOverlay, set, show, svg } from "./svg";
import { brushRadiusAt, clickStroke, combineOf, type ToolContext, type Pointer, type Stroke, type Tool } from "./tool";

/** A circle on the page that shows the size of the brush. */
export class BrushRing {
  private readonly circles = [svg("circle"), svg("circle")];
  private readonly element = svg("g", { class: "brush-ring", display: "none" }, ...this.circles);

  constructor(private readonly context: ToolContext) {
    context.viewport.overlay.append(this.element);
  }
  show(pointer: Pointer): void {
    const { screenPoint, ctrl, alt } = pointer;
    const [at] = onOverlay(this.context.viewport.overlay, [screenPoint]) as [ScreenPoint];
    const r = brushRadiusAt(this.context.editor.tools.brushRadiusPx.value, pointer);
    for (const circle of this.circles) set(circle, { cx: at.x, cy: at.y, r });
    set(this.element, { class: `brush-ring${ctrl || alt ? " removes" : ""}` });
    show(this.element, true);
  }
  hide(): void {
    show(this.element, false);
  }
}

/** The vertices under the brush along a stroke, each reported once. */
export class BrushStroke {
  readonly painted = new Set<number>();
  private readonly path: StrokePath;

  constructor(
    private readonly context: ToolContext,
    private readonly surface: Surface,
    start: ScreenPoint,
  ) {
    this.path = new StrokePath(start);
  }

  /** Returns the vertices that newly come under the brush on the way to the pointer. */
  to(pointer: Pointer): Uint32Array {
    const { tools } = this.context.editor;
    const radiusPx = brushRadiusAt(tools.brushRadiusPx.value, pointer);
    const fresh: number[] = [];
    for (const { x, y } of this.path.to(pointer.screenPoint, 0.5 * radiusPx)) {
      const hit = this.context.viewport.pick(x, y);
      if (hit?.surface !== this.surface) continue;
      const radius = radiusPx * this.context.viewport.worldPerPixel(hit.point);
      for (const v of this.context.viewport.verticesNear(this.surface, hit, radius, tools.through.value))
        if (!this.painted.has(v)) {
          this.painted.add(v);
          fresh.push(v);
        }
    }
    return Uint32Array.from(fresh);
  }

  get vertices(): Uint32Array {
    return Uint32Array.from(this.painted).sort();
  }
}

export class BrushTool implements Tool {
  readonly cursor = "crosshair";
  private readonly ring: BrushRing;

  constructor(private readonly context: ToolContext) {
    this.ring = new BrushRing(context);
  }

  hover(pointer: Pointer): void {
    this.ring.show(pointer);
  }
  leave(): void {
    this.ring.hide();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    if (hit === undefined) return undefined;
    const { surface } = hit;
    const { editor } = this.context;
    const how = combineOf(this.context, pointer);
    const before = surface.selection.slice();
    if (how === "set") surface.setSelection(new Uint32Array());
    const stroke = new BrushStroke(this.context, surface, pointer.screenPoint);
    const paint = (at: Pointer) => {
      this.ring.show(at);
      surface.markSelected(stroke.to(at), how !== "remove");
    };
    paint(pointer);
    return {
      followsPath: true,
      move: paint,
      end: () => void editor.ask({ do: "select", mesh: editor.graft.nameOf(surface.id), how, what: { indices: [...stroke.vertices] } }),
      cancel: () => surface.setSelection(selectedIn(before)),
    };
  }
}

/** Selects by an outline: a lasso or a rectangle. A stroke may begin off the model. */
export class OutlineTool implements Tool {
  readonly cursor = "crosshair";
  readonly beginsOffSurface = true;
  private readonly outline = svg("path", { class: "outline", display: "none" });

  constructor(
    private readonly context: ToolContext,
    private readonly isBox: boolean,
  ) {
    context.viewport.overlay.append(this.outline);
  }

  hover(): void {}
  leave(): void {
    show(this.outline, false);
  }

  press(pointer: Pointer): Stroke | undefined {
    const surface = this.context.viewport.main;
    if (surface === undefined) return undefined;
    const screenPoints = [pointer.screenPoint];
    const how = combineOf(this.context, pointer);
    const draw = ({ screenPoint }: Pointer) => {
      const [first = screenPoint] = screenPoints;
      if (this.isBox) screenPoints.splice(0, 4, first, { x: screenPoint.x, y: first.y }, screenPoint, { x: first.x, y: screenPoint.y });
      else screenPoints.push(screenPoint);
      set(this.outline, { d: linesThrough(onOverlay(this.context.viewport.overlay, screenPoints), true) });
      set(this.outline, { class: `outline${how === "remove" ? " removes" : ""}` });
      show(this.outline, true);
    };
    return {
      followsPath: !this.isBox,
      move: draw,
      end: (at) => {
        draw(at);
        show(this.outline, false);
        this.take(surface, screenPoints, how);
      },
      cancel: () => show(this.outline, false),
    };
  }

  private take(surface: Surface, screenPoints: readonly ScreenPoint[], how: "set" | "add" | "remove"): void {
    const polygon = screenPoints.map(({ x, y }): [number, number] => [x, y]);
    if (areaOf(screenPoints) < 9) return; // a click
    const { viewport, editor } = this.context;
    const vertices = viewport.verticesInPolygon(surface, polygon, editor.tools.through.value);
    if (vertices.length === 0 && how !== "set") return;
    if (how === "set") surface.setSelection(vertices);
    else surface.markSelected(vertices, how === "add");
    void editor.ask({ do: "select", how, what: { indices: [...vertices] } });
  }
}

/** Selects a set of vertices by a click, and highlights it beforehand. */
export abstract class ClickTool implements Tool {
  readonly cursor = "pointer";
  private shownKey: string | undefined;

  constructor(protected readonly context: ToolContext) {}

  /**
   * Returns the set that a click would select: a key that identifies it, its vertices, and the selection to request.
   */
  protected abstract find(pointer: Pointer, hit: Hit | undefined): Found | undefined;

  hover(pointer: Pointer, hit: Hit | undefined): void {
    const found = this.find(pointer, hit);
    if (found === undefined) return this.leave();
    if (found.key !== this.shownKey) {
      this.leave();
      this.shownKey = found.key;
      this.present(found);
    }
    const count = found.vertices === undefined ? "" : `: ${found.vertices.length.toLocaleString("en")} vertices`;
    this.context.status.say(`${found.words}${count}`, pointer.screenPoint);
  }
  leave(): void {
    this.shownKey = undefined;
    this.context.preview.hide();
    this.context.status.clear();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    const found = this.find(pointer, hit);
    if (found === undefined) return undefined;
    const how = combineOf(this.context, pointer);
    return clickStroke(() => void this.context.editor.ask({ do: "select", how, what: found.ask }));
  }

  protected present({ surface, vertices }: Found): void {
    if (vertices !== undefined) this.context.preview.show(surface, vertices);
  }
}

interface Found {
  readonly key: string;
  readonly surface: Surface;
  readonly vertices: Uint32Array | undefined; // undefined: not known to the page yet
  readonly words: string;
  readonly ask: AskedSelection;
}

export class ConnectedTool extends ClickTool {
  private last: { surface: Surface; vertices: Uint32Array; has: Uint8Array } | undefined;

  protected find(_pointer: Pointer, hit: Hit | undefined): Found | undefined {
    if (hit === undefined) return undefined;
    const { surface, vertex } = hit;
    const graph = this.context.graphs.of(surface);
    const first = graph?.first(vertex) ?? vertex;
    if (graph !== undefined && (this.last?.surface !== surface || this.last.has[first] === 0)) {
      const vertices = graph.component(vertex);
      const has = new Uint8Array(surface.vertexCount);
      for (const v of vertices) has[v] = 1;
      this.last = { surface, vertices, has };
    }
    const vertices = graph === undefined ? undefined : this.last?.vertices;
    const key = `part ${surface.id} ${vertices?.[0] ?? "?"}`;
    return { key, surface, vertices, words: "Connected", ask: { component_of: vertex } };
  }
}

export class FloodTool extends ClickTool {
  protected find(_pointer: Pointer, hit: Hit | undefined): Found | undefined {
    if (hit === undefined) return undefined;
    const { surface, vertex } = hit;
    const angle = this.context.editor.tools.floodAngleDeg.value;
    const isQuick = surface.vertexCount < 300_000; // in larger meshes the set is shown after the click
    const vertices = isQuick ? this.context.graphs.of(surface)?.flood(vertex, angle) : undefined;
    return {
      key: `flood ${surface.id} ${vertex} ${angle} ${vertices?.length}`, surface, vertices,
      words: `Up to ${angle}°`, ask: { flood: { vertex, angle_deg: angle } },
    };
  }
}

/** Selects the boundary loop nearest to the pointer, even if the pointer is in the hole. */
export class LoopTool extends ClickTool {
  private readonly line = svg("path", { class: "loop", display: "none" });

  constructor(context: ToolContext) {
    super(context);
    context.viewport.overlay.append(this.line);
    context.viewport.onFrame.add(() => this.draw());
  }

  private loop: { surface: Surface; vertices: Uint32Array } | undefined;

  protected find({ screenPoint }: Pointer): Found | undefined {
    const surface = this.context.viewport.main;
    const graph = surface === undefined ? undefined : this.context.graphs.of(surface);
    if (surface === undefined || graph === undefined) return undefined;
    let least = nearPx;
    let found: { vertices: Uint32Array; vertex: number } | undefined;
    const position = new Vector3();
    for (const vertices of graph.loops)
      for (const vertex of vertices) {
        const { x, y, behind } = this.context.viewport.project(surface.positionOf(vertex, position));
        const distance = Math.hypot(x - screenPoint.x, y - screenPoint.y);
        if (behind || distance >= least) continue;
        least = distance;
        found = { vertices, vertex };
      }
    if (found === undefined) return undefined;
    const { vertices, vertex } = found;
    const key = `loop ${surface.id} ${vertices[0]}`;
    return { key, surface, vertices, words: "Boundary loop", ask: { loop_of: vertex } };
  }

  protected override present(found: Found): void {
    this.loop = found.vertices === undefined ? undefined : { surface: found.surface, vertices: found.vertices };
    this.draw();
  }
  override leave(): void {
    super.leave();
    this.loop = undefined;
    this.draw();
  }

  private draw(): void {
    show(this.line, this.loop !== undefined);
    if (this.loop === undefined) return;
    const { surface, vertices } = this.loop;
    const screenPoints = Array.from(vertices, (v) => this.context.viewport.project(surface.positionOf(v)));
    set(this.line, { d: linesThrough(onOverlay(this.context.viewport.overlay, screenPoints), true) });
  }
}

const nearPx = 120; // largest distance from a loop at which it is chosen

function selectedIn(flags: Uint8Array): Uint32Array {
  const found: number[] = [];
  flags.forEach((flag, v) => flag !== 0 && found.push(v));
  return Uint32Array.from(found);
}

/** Returns the area of a closed outline, in square pixels. */
function areaOf(screenPoints: readonly ScreenPoint[]): number {
  let twice = 0;
  screenPoints.forEach((a, i) => {
    const b = screenPoints[(i + 1) % screenPoints.length] as ScreenPoint;
    twice += a.x * b.y - b.x * a.y;
  });
  return Math.abs(twice) / 2;
}
