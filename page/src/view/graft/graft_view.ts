import { effect, untracked } from "@preact/signals";
import { Group, Matrix4, Vector3 } from "three";
import type { Graft, LoopRef, MeshObject } from "../../app/graft/graft";
import type { Rows4, Vector3Tuple } from "../../app/graft/graft_step";
import type { BinaryMessage } from "../../engine/binary_message";
import { layOutParts, type Box } from "./part_layout";
import { trianglesFrom, verticesFrom } from "../../app/graft/seam";
import { partColour, seamColour } from "../../app/graft/graft_colours";
import { Ghost, MatchLines } from "./graft_lines";
import { LoopLines } from "./loop_lines";
import { writeTint } from "../surface/roles";
import type { Surface } from "../surface/surface";
import type { Viewport } from "../viewport";

/** Shows parts beside the model, their loops, the correspondence, and the result of a graft. Follows `Graft`. */
export class GraftView {
  private readonly group = new Group(); // in the target's coordinates
  private readonly loops: LoopLines;
  private readonly lines = new MatchLines();
  private readonly ghost = new Ghost();
  private preview: { message: BinaryMessage; surface: Surface } | undefined;
  private readonly directions = new Map<string, Vector3Tuple>(); // directions of parts as seen from the model
  private seamShownOn: Surface | undefined; // the model that has the seam of the latest graft
  private framedKey = ""; // key of the objects in the last framed picture

  constructor(
    private readonly viewport: Viewport,
    private readonly graft: Graft,
  ) {
    this.loops = new LoopLines(viewport);
    this.group.matrixAutoUpdate = false;
    viewport.scene.add(this.group, this.lines.object, this.ghost.object);
    viewport.alsoShown = () => {
      const surface = this.preview?.surface;
      return surface?.object.visible === true ? [[surface, this.group.matrix]] : [];
    };
  }

  /** Begins to follow the graft. */
  start(): void {
    effect(() => this.viewport.parts.keep(new Set(this.graft.parts.value.map((part) => part.mesh))));
    effect(() => {
      if (this.graft.mode.value === "graft") void this.graft.needLoops();
    });
    effect(() => this.update());
  }

  /** Returns where a vertex of a mesh is shown, in world coordinates. */
  positionOf(mesh: number, vertex: number, out = new Vector3()): Vector3 | undefined {
    const surface = this.viewport.surfaceOf(mesh);
    const matrix = this.viewport.parts.get(mesh)?.matrixWorld;
    if (surface === undefined) return undefined;
    surface.positionOf(vertex, out);
    return matrix === undefined ? out : out.applyMatrix4(matrix);
  }

  /** Returns the centre of a mesh's box where it is shown. */
  centreOf(mesh: number): Vector3 {
    const centre = this.viewport.surfaceOf(mesh)?.sphere().center ?? new Vector3();
    return centre.applyMatrix4(this.matrixWorldOf(mesh));
  }

  /** Returns the map from a mesh's own coordinates to where it is shown. */
  matrixWorldOf(mesh: number): Matrix4 {
    return this.viewport.parts.get(mesh)?.matrixWorld ?? new Matrix4();
  }

  /** Returns whether the mesh itself is visible. */
  isVisible(mesh: number): boolean {
    const part = this.viewport.parts.get(mesh);
    return part?.group.visible ?? this.viewport.surfaces.get(mesh)?.object.visible ?? false;
  }

  /** Returns the loops that can be clicked now. */
  clickableLoops(): LoopRef[] {
    return this.loops.refs();
  }

  /** The map from the target's coordinates to where they are shown. */
  get targetMatrixWorld(): Matrix4 {
    return this.group.matrix;
  }

  private update(): void {
    const { graft, viewport } = this;
    void viewport.parts.changed.value;
    const on = graft.mode.value === "graft";
    const shows = on ? graft.shownMeshes.value : new Set([graft.model.value?.mesh ?? -1]);
    for (const surface of viewport.surfaces.values()) surface.object.visible = !on || shows.has(surface.id);
    for (const part of graft.parts.value) {
      const shown = viewport.parts.get(part.mesh);
      if (shown !== undefined) shown.group.visible = on && shows.has(part.mesh);
    }
    this.arrangeParts(shows);
    const target = viewport.parts.get(graft.target.value?.mesh ?? -1);
    this.group.matrix.copy(target?.matrixWorld ?? new Matrix4());
    this.group.updateMatrixWorld(true);
    this.showPreview(on);
    this.keepSeam();
    this.drawLoops(on, shows);
    this.drawLines(on, shows);
    this.drawGhost(on);
    viewport.updateBounds();
    this.frameIfNew(on, shows);
    viewport.requestRender();
  }

  private arrangeParts(shows: ReadonlySet<number>): void {
    const { graft, viewport } = this;
    const main = viewport.main;
    if (main === undefined) return;
    for (const name of this.directions.keys()) if (graft.byName(name) === undefined) this.directions.delete(name);
    const posed = graft.step.value?.pose === "keep" ? graft.source.value?.mesh : undefined;
    const arranged = graft.parts.value.filter((part) => part.mesh !== posed && this.isArranged(part, shows));
    const surfaces = arranged.map((part) => viewport.parts.get(part.mesh)).filter((part) => part !== undefined);
    const boxes = arranged.flatMap(({ mesh, name }) => {
      const part = viewport.parts.get(mesh);
      return part === undefined ? [] : [{ ...boxOf(part.surface), towards: this.directionOf(name) }];
    });
    const transforms = layOutParts(boxOf(main), boxes);
    surfaces.forEach((part, i) => {
      const { scale = 1, offset = [0, 0, 0] } = transforms[i] ?? {};
      part.matrixWorld = new Matrix4().makeScale(scale, scale, scale).setPosition(...offset);
    });
    const part = posed === undefined ? undefined : viewport.parts.get(posed);
    if (part !== undefined) part.matrixWorld = this.keptPose();
  }

  // A part is placed to the camera's right at the time it was added, and stays there while the view turns.
  private directionOf(part: string): Vector3Tuple {
    const known = this.directions.get(part);
    if (known !== undefined) return known;
    const direction = this.viewport.navigation.rightward().toArray();
    if (this.graft.mode.value === "graft") this.directions.set(part, direction);
    return direction;
  }

  // A part that is in the result keeps its position in the row, so that the others do not move.
  private isArranged(part: MeshObject, shows: ReadonlySet<number>): boolean {
    return shows.has(part.mesh) || part.name === this.graft.step.value?.source || part.name === this.graft.step.value?.target;
  }

  /** Returns the map of a part that keeps its pose, before it deforms. */
  private keptPose(): Matrix4 {
    const rows = this.graft.transform.value ?? this.graft.step.value?.sourceTransform;
    return rows === undefined ? new Matrix4() : matrixOfRows(rows);
  }

  private showPreview(on: boolean): void {
    const { value: message } = this.graft.preview;
    const before = this.preview;
    if (before !== undefined && before.message !== message) {
      this.group.remove(before.surface.object);
      this.preview = undefined;
    }
    if (message !== null && this.preview === undefined) {
      const surface = this.viewport.surfaceFrom(message);
      surface.setTint(tintOf(message, surface.vertexCount));
      this.seamShownOn = undefined;
      surface.heat.setSeam(verticesFrom(message, 2));
      const positions = message.floats("rest");
      const triangles = trianglesFrom(message, (origin) => origin !== 2);
      if (positions !== undefined) surface.heat.setUnstretched({ positions, triangles });
      this.preview = { message, surface };
      this.group.add(surface.object);
    }
    const isShown = on && this.graft.arrangement.value !== "apart";
    if (this.preview !== undefined) this.preview.surface.object.visible = isShown;
    untracked(() => this.viewport.showReplacement(isShown ? this.preview?.surface : undefined));
    if (before !== this.preview) before?.surface.dispose();
  }

  // Gives the model the seam of the graft that it came from, so that its heat map outlives the graft.
  private keepSeam(): void {
    const { main } = this.viewport;
    const { value: seam } = this.graft.seam;
    if (main === undefined || main === this.seamShownOn || main.vertexCount !== seam?.vertexCount) return;
    this.seamShownOn = main;
    main.heat.setSeam(seam.vertices);
  }

  private drawLoops(on: boolean, shows: ReadonlySet<number>): void {
    const { graft } = this;
    const seen = new Map([...graft.loops.value].filter(([mesh]) => on && this.hasLoopsShown(mesh, shows)));
    this.loops.show(seen, {
      pairs: graft.pairs.value,
      source: graft.source.value?.mesh,
      target: graft.target.value?.mesh,
      hovered: graft.hovered.value,
      picked: graft.picked.value,
    });
  }

  // The target's loops stay visible in the seam while the part is also shown beside it.
  private hasLoopsShown(mesh: number, shows: ReadonlySet<number>): boolean {
    return shows.has(mesh) || (this.graft.arrangement.value === "both" && mesh === this.graft.target.value?.mesh);
  }

  private drawLines(on: boolean, shows: ReadonlySet<number>): void {
    const { value: message } = this.graft.preview;
    const source = this.graft.source.value?.mesh ?? -1;
    if (!on || message === null || !shows.has(source)) return this.lines.hide();
    this.lines.show(message, (vertex) => this.positionOf(source, vertex), this.group.matrix);
  }

  private drawGhost(on: boolean): void {
    const { graft } = this;
    const { value: rows } = graft.transform;
    const source = this.viewport.surfaceOf(graft.source.value?.mesh ?? -1);
    const moves = graft.dragged.value !== null && (graft.step.value?.at !== undefined || graft.step.value?.pose === "keep");
    if (!on || !moves || rows === null || source === undefined) return this.ghost.hide();
    this.ghost.show(source, this.group.matrix.clone().multiply(matrixOfRows(rows)));
  }

  /** Frames everything when the shown objects change, or come back with the part out of the view. A dropped part causes this only if it reaches out of the view. */
  private frameIfNew(on: boolean, shows: ReadonlySet<number>): void {
    const { isBeingDropped, dragged, step } = this.graft;
    if (isBeingDropped.value !== null || dragged.value !== null) return;
    const there = [...shows].filter((mesh) => this.viewport.surfaceOf(mesh) !== undefined);
    const key = on ? `${there.sort().join()} ${this.preview?.surface.object.visible === true}` : "";
    if (key === this.framedKey) return;
    const grew = this.framedKey !== "" || shows.size > 1 || !this.isPartInView();
    this.framedKey = key;
    if (step.value?.at !== undefined && this.isPartInView()) return;
    if (grew && this.viewport.main !== undefined) untracked(() => this.viewport.fit("all"));
  }

  private isPartInView(): boolean {
    if (this.preview === undefined) return true;
    const { message, surface } = this.preview;
    return untracked(() => this.viewport.isInView(surface, verticesFrom(message, 1)));
  }
}

export function rowsOfMatrix(matrix: Matrix4): Rows4 {
  const e = matrix.clone().transpose().toArray();
  const row = (i: 0 | 1 | 2 | 3): Rows4[0] => [e[4 * i] ?? 0, e[4 * i + 1] ?? 0, e[4 * i + 2] ?? 0, e[4 * i + 3] ?? 0];
  return [row(0), row(1), row(2), row(3)];
}

export function matrixOfRows(rows: readonly (readonly number[])[]): Matrix4 {
  return new Matrix4().fromArray(rows.flat()).transpose();
}

function boxOf(surface: Surface): Box {
  const at = (corner: Vector3) => corner.clone().add(surface.object.position).toArray();
  return { min: at(surface.box.min), max: at(surface.box.max) };
}

/** Tints the part weakly in its colour, and the seam strongly. */
function tintOf(message: BinaryMessage, vertices: number): Uint8Array {
  const tint = new Uint8Array(4 * vertices);
  const triangles = message.indices("triangles") ?? new Uint32Array();
  const origin = message.bytes("origin") ?? new Uint8Array();
  const paint = (kind: number, colour: typeof seamColour | typeof partColour, strength: number) => {
    for (let t = 0; t < origin.length; ++t)
      if (origin[t] === kind) for (let k = 0; k < 3; ++k) writeTint(tint, triangles[3 * t + k] ?? 0, colour, strength);
  };
  paint(1, partColour, 0.3);
  paint(2, seamColour, 0.7);
  return tint;
}
