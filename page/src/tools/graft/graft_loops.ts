import { effect } from "@preact/signals";
import { Vector3 } from "three";
import type { LoopRef } from "../../app/graft/graft";
import {
  matchesOf, withMatch, withMovedMatch, withoutMatch,
  type MatchRef, type MatchedVertices,
} from "../../app/graft/graft_step";
import { areInOrder, matchingParameter, nearestPoint } from "../../app/graft/loop_curve";
import { cssColour, pairColour } from "../../app/graft/graft_colours";
import { forFingers } from "../../app/pointer_kind";
import type { GraftView } from "../../view/graft/graft_view";
import type { ScreenPoint } from "../screen_camera";
import { onOverlay, set, show, svg } from "../svg";
import { clickStroke, type ToolContext, type Pointer, type Stroke, type Tool } from "../tool";

const nearPx = { loop: 14, match: 11 };

/** One end of a match, on the source loop or on the target loop. */
interface MatchEnd extends MatchRef {
  readonly side: 0 | 1; // 0: source, 1: target
  readonly mesh: number;
  readonly vertex: number;
}

/** Pairs loops by clicks, and drags matches along them. */
export class LoopPairTool implements Tool {
  readonly cursor = "default";
  private readonly element = svg("g", { class: "graft-dots" });
  private readonly dots = new Map<string, SVGGElement>();
  private pointer: Pointer | undefined;
  private hoveredEnd: MatchEnd | undefined;

  constructor(
    private readonly context: ToolContext,
    private readonly view: GraftView,
  ) {
    context.viewport.overlay.append(this.element);
    context.viewport.onFrame.add(() => this.draw());
    effect(() => {
      const { pairs, activeMatch, report, activePair } = this.graft;
      void [pairs.value, activeMatch.value, report.value, activePair.value];
      context.viewport.requestRender();
    });
  }

  private get graft() {
    return this.context.editor.graft;
  }

  hover(pointer: Pointer): void {
    this.pointer = pointer;
    const { canvas } = this.context.viewport;
    const end = this.endAt(pointer.screenPoint);
    const { hoveredEnd: last } = this;
    if (last?.pair !== end?.pair || last?.match !== end?.match || last?.side !== end?.side) {
      this.hoveredEnd = end;
      this.context.viewport.requestRender();
    }
    const near = end === undefined ? this.loopAt(pointer.screenPoint) : undefined;
    this.graft.hovered.value = near?.ref ?? null;
    canvas.style.cursor = end !== undefined ? "grab" : near !== undefined ? "pointer" : "default";
    if (end !== undefined) this.context.status.say(wordsOfMatch(end), pointer.screenPoint);
    else if (near !== undefined) this.context.status.say(this.wordsOfLoop(near.ref), pointer.screenPoint);
    else this.context.status.clear();
  }

  leave(): void {
    this.hoveredEnd = undefined;
    this.graft.hovered.value = null;
    this.context.status.clear();
  }

  press(pointer: Pointer): Stroke | undefined {
    this.pointer = pointer;
    const end = this.endAt(pointer.screenPoint);
    if (end !== undefined) return this.dragEnd(end);
    const near = this.loopAt(pointer.screenPoint);
    if (near === undefined) {
      this.graft.activeMatch.value = null;
      return undefined;
    }
    return clickStroke(() => this.click(near.ref));
  }

  private click(ref: LoopRef): void {
    const pair = this.pairOf(ref);
    if (pair >= 0) this.graft.activePair.value = pair;
    void this.graft.pick(ref);
  }

  /** Adds a match at a double click on a paired loop. */
  confirm(): boolean {
    const near = this.pointer && this.loopAt(this.pointer.screenPoint);
    const index = near === undefined ? -1 : this.pairOf(near.ref);
    if (near === undefined || index < 0) return false;
    this.graft.picked.value = null;
    const vertices = this.matchAt(near.ref, near.vertex, index);
    if (vertices === undefined) return false;
    const pairs = withMatch(this.graft.pairs.value, index, vertices, this.graft.starts.of(index));
    this.graft.activeMatch.value = { pair: index, match: pairs[index]?.matches.length ?? 0 };
    void this.graft.setPairs(pairs);
    return true;
  }

  escape(): boolean {
    if (this.graft.picked.value === null && this.graft.activeMatch.value === null) return false;
    this.graft.picked.value = this.graft.activeMatch.value = null;
    return true;
  }

  takeKey({ key }: KeyboardEvent): boolean {
    const { value: active } = this.graft.activeMatch;
    if (active === null || (key !== "Delete" && key !== "Backspace")) return false;
    this.graft.activeMatch.value = null;
    void this.graft.setPairs(withoutMatch(this.graft.pairs.value, active));
    return true;
  }

  /** Drags one end along its loop, from vertex to vertex. Positions that would make matches cross are skipped. */
  private dragEnd(end: MatchEnd): Stroke {
    const before = this.graft.pairs.value;
    this.graft.activeMatch.value = { pair: end.pair, match: end.match };
    const curves = before[end.pair] && this.graft.starts.curvesOf(before[end.pair] as (typeof before)[number]);
    const curve = end.side === 0 ? curves?.source : curves?.target;
    let { vertex } = end;
    return {
      move: ({ screenPoint }) => {
        const next = curve && this.nearestVertex(end.mesh, curve.vertices, screenPoint);
        if (next === undefined || next === vertex) return;
        const moved = this.movedMatch(end, next);
        if (moved === undefined) return;
        vertex = next;
        this.graft.dragPairs(withMovedMatch(before, end, moved));
      },
      end: () => void this.graft.keepDragged(),
      cancel: () => void this.graft.forgetDragged(),
    };
  }

  private movedMatch(end: MatchEnd, vertex: number): MatchedVertices | undefined {
    const pair = this.graft.pairs.value[end.pair];
    const curves = pair && this.graft.starts.curvesOf(pair);
    if (pair === undefined || curves === undefined) return undefined;
    const all = matchesOf(pair, this.graft.starts.of(end.pair));
    const old = all[end.match];
    if (old === undefined) return undefined;
    const moved: MatchedVertices = end.side === 0 ? [vertex, old[1]] : [old[0], vertex];
    const known = all.map((other, i) => (i === end.match ? moved : other)).filter((other) => other !== undefined);
    return areInOrder(curves.source, curves.target, known) ? moved : undefined;
  }

  // Returns the match of a vertex by arc length along both loops, starting from the pair's start.
  private matchAt(ref: LoopRef, vertex: number, index: number): MatchedVertices | undefined {
    const pair = this.graft.pairs.value[index];
    const curves = pair && this.graft.starts.curvesOf(pair);
    const start = this.graft.starts.of(index);
    if (curves === undefined || start === undefined) return undefined;
    const onSource = ref.mesh === this.graft.source.value?.mesh && curves.source.has(vertex);
    if (onSource) {
      const parameter = matchingParameter(curves.source, curves.target, start, vertex);
      return parameter === undefined ? undefined : [vertex, curves.target.vertexAt(parameter - Math.floor(parameter))];
    }
    const parameter = matchingParameter(curves.target, curves.source, [start[1], start[0]], vertex);
    return parameter === undefined ? undefined : [curves.source.vertexAt(parameter - Math.floor(parameter)), vertex];
  }

  private pairOf(ref: LoopRef): number {
    const source = this.graft.source.value?.mesh;
    const target = this.graft.target.value?.mesh;
    return this.graft.pairs.value.findIndex(
      ({ sourceLoop, targetLoop }) =>
        (ref.mesh === source && ref.loop === sourceLoop) || (ref.mesh === target && ref.loop === targetLoop),
    );
  }

  /** Returns the loop under the pointer and its nearest vertex. */
  private loopAt(screenPoint: ScreenPoint): { ref: LoopRef; vertex: number } | undefined {
    let best: { ref: LoopRef; vertex: number } | undefined;
    let least: number = nearPx.loop;
    for (const ref of this.view.clickableLoops()) {
      const vertices = this.graft.loops.value.get(ref.mesh)?.[ref.loop]?.vertices ?? new Uint32Array();
      const { index, distance } = nearestPoint(this.screenPointsOf(ref.mesh, vertices), screenPoint.x, screenPoint.y);
      if (index < 0 || distance >= least) continue;
      least = distance;
      best = { ref, vertex: vertices[index] as number };
    }
    return best;
  }

  private nearestVertex(mesh: number, vertices: Uint32Array, { x, y }: ScreenPoint): number | undefined {
    const { index } = nearestPoint(this.screenPointsOf(mesh, vertices), x, y);
    return vertices[index];
  }

  // Returns the screen points of vertices (2 numbers each). Points along the edges are not added, not even for coarse
  // loops.
  private screenPointsOf(mesh: number, vertices: Uint32Array): Float64Array {
    const screenPoints = new Float64Array(2 * vertices.length).fill(Infinity);
    const position = new Vector3();
    vertices.forEach((v, i) => {
      if (this.view.positionOf(mesh, v, position) === undefined) return;
      const { x, y, behind } = this.context.viewport.project(position);
      if (!behind) screenPoints.set([x, y], 2 * i);
    });
    return screenPoints;
  }

  private ends(): MatchEnd[] {
    const { source, target, pairs, mode, tool, preview, arrangement } = this.graft;
    if (mode.value !== "graft" || tool.value !== "loops") return [];
    const meshes = [source.value?.mesh ?? -1, target.value?.mesh ?? -1] as const;
    const seen = [this.view.isVisible(meshes[0]), this.view.isVisible(meshes[1]) || (preview.value !== null && arrangement.value !== "apart")];
    return pairs.value.flatMap((pair, index) =>
      matchesOf(pair, this.graft.starts.of(index)).flatMap((vertices, match) =>
        ([0, 1] as const).flatMap((side): MatchEnd[] => {
          const [mesh, vertex] = [meshes[side], vertices?.[side]];
          return vertex === undefined || seen[side] !== true ? [] : [{ pair: index, match, side, mesh, vertex }];
        }),
      ),
    );
  }

  private endAt(screenPoint: ScreenPoint): MatchEnd | undefined {
    let best: MatchEnd | undefined;
    let least: number = nearPx.match;
    for (const end of this.ends()) {
      const position = this.view.positionOf(end.mesh, end.vertex);
      if (position === undefined) continue;
      const { x, y, behind } = this.context.viewport.project(position);
      const distance = Math.hypot(x - screenPoint.x, y - screenPoint.y);
      if (behind || distance > least) continue;
      least = distance;
      best = end;
    }
    return best;
  }

  private draw(): void {
    const ends = this.ends();
    const wanted = new Set(ends.map(keyOf));
    for (const [key, element] of this.dots)
      if (!wanted.has(key)) {
        element.remove();
        this.dots.delete(key);
      }
    for (const end of ends) this.drawEnd(end);
  }

  private drawEnd(end: MatchEnd): void {
    const position = this.view.positionOf(end.mesh, end.vertex);
    const element = this.elementOf(end);
    const at = position && this.context.viewport.project(position);
    show(element, at !== undefined && !at.behind);
    if (at === undefined) return;
    const [screenPoint] = onOverlay(this.context.viewport.overlay, [at]) as [ScreenPoint];
    const { value: active } = this.graft.activeMatch;
    const isHovered = this.hoveredEnd !== undefined && keyOf(this.hoveredEnd) === keyOf(end);
    const isChosen = active?.pair === end.pair && active.match === end.match;
    const given = end.match > 0 || this.graft.pairs.value[end.pair]?.start !== undefined;
    set(element, {
      transform: `translate(${screenPoint.x.toFixed(1)} ${screenPoint.y.toFixed(1)})`,
      class: `graft-dot${end.match === 0 ? " start" : ""}${isHovered ? " hot" : ""}${isChosen ? " chosen" : ""}${given ? "" : " found"}`,
      style: `--own: ${cssColour(pairColour(end.pair))}`,
    });
  }

  // Draws a start as a rhombus with the number of its pair, and a match as a circle.
  private elementOf(end: MatchEnd): SVGGElement {
    const key = keyOf(end);
    const known = this.dots.get(key);
    if (known !== undefined) return known;
    const shape = end.match === 0 ? svg("path", { d: "M0 -10L10 0L0 10L-10 0Z" }) : svg("circle", { r: 6 });
    const made = svg("g", {}, shape);
    if (end.match === 0) {
      const label = svg("text", { y: 4 });
      label.textContent = String(end.pair + 1);
      made.append(label);
    }
    this.dots.set(key, made);
    this.element.append(made);
    return made;
  }

  private wordsOfLoop(ref: LoopRef): string {
    const loop = this.graft.loops.value.get(ref.mesh)?.[ref.loop];
    const object = this.graft.byMesh(ref.mesh);
    if (loop === undefined || object === undefined) return "";
    const { value: unit } = this.context.viewport.settings.unit;
    const length = Number(loop.length.toPrecision(3)).toString();
    const what = `${object.name}, loop ${ref.loop + 1}: ${loop.vertices.length} vertices, ${length}${unit === "none" ? "" : ` ${unit}`} around`;
    if (this.pairOf(ref) >= 0) return forFingers(`${what} · double-click to add a match`);
    const { value: picked } = this.graft.picked;
    return picked !== null && picked.mesh !== ref.mesh ? forFingers(`${what} · click to pair`) : what;
  }
}

function keyOf({ pair, match, side }: MatchEnd): string {
  return `${pair} ${match} ${side}`;
}

function wordsOfMatch({ pair, match }: MatchEnd): string {
  const what = match === 0 ? `Marker of pair ${pair + 1}` : `Match ${match} of pair ${pair + 1}`;
  return `${what} · drag it along the loop; Delete ${match === 0 ? "resets" : "removes"} it`;
}
