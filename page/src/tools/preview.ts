import { BufferAttribute, BufferGeometry, Matrix4, Mesh, MeshBasicMaterial, Points, PointsMaterial } from "three";
import type { Surface } from "../view/surface/surface";
import type { Viewport } from "../view/viewport";
import type { GraphStore } from "./graph_store";

/** Highlights vertices of a surface in a colour, such as those that a click would take or a handle's new position. */
export class Preview {
  private readonly geometry = new BufferGeometry();
  private readonly faces: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly dots: Points<BufferGeometry, PointsMaterial>;
  private readonly dotGeometry = new BufferGeometry();
  private isShown = false;

  constructor(
    private readonly viewport: Viewport,
    private readonly graphs: GraphStore,
    colour: number,
    opacity: number,
  ) {
    const look = { color: colour, transparent: true, opacity, depthWrite: false };
    const nearer = { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 };
    this.faces = new Mesh(this.geometry, new MeshBasicMaterial({ ...look, ...nearer, side: 2 }));
    this.dots = new Points(this.dotGeometry, new PointsMaterial({ ...look, size: 5, sizeAttenuation: false }));
    for (const object of [this.faces, this.dots]) {
      object.frustumCulled = false;
      object.matrixAutoUpdate = false;
      object.visible = false;
      viewport.scene.add(object);
    }
  }

  /**
   * Shows vertices and the triangles between them. With `map`: at rest, moved by it. Otherwise at their shown
   * positions.
   */
  show(surface: Surface, vertices: Iterable<number>, map?: Matrix4): void {
    const list = [...vertices];
    const faces = this.graphs.of(surface)?.facesInside(list) ?? [];
    const corners = new Uint32Array(3 * faces.length);
    faces.forEach((face, i) => corners.set(surface.triangles.subarray(3 * face, 3 * face + 3), 3 * i));
    const positions = new BufferAttribute(map === undefined ? surface.positions : surface.rest, 3);
    this.setAttributes(this.geometry, positions, corners);
    this.setAttributes(this.dotGeometry, positions, faces.length === 0 ? Uint32Array.from(list) : new Uint32Array());
    this.setMap(surface, map);
    this.setShown(true);
    this.viewport.requestRender();
  }

  /** Moves the shown vertices by another map, from the next picture on. */
  setMap(surface: Surface, map = new Matrix4()): void {
    const at = map.clone().multiply(new Matrix4().setPosition(...surface.offset));
    for (const object of [this.faces, this.dots]) {
      object.matrix.copy(at);
      object.matrixWorldNeedsUpdate = true;
    }
  }

  hide(): void {
    if (!this.isShown) return;
    this.setShown(false);
    this.geometry.dispose();
    this.dotGeometry.dispose();
    this.viewport.requestRender();
  }

  private setAttributes(geometry: BufferGeometry, positions: BufferAttribute, index: Uint32Array): void {
    geometry.dispose(); // frees the GPU's copy
    geometry.setAttribute("position", positions);
    geometry.setIndex(new BufferAttribute(index, 1));
  }

  private setShown(isShown: boolean): void {
    this.isShown = isShown;
    this.faces.visible = this.dots.visible = isShown;
  }
}
