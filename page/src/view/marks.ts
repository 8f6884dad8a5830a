import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  DoubleSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  Points,
  PointsMaterial,
  Vector3,
  type Material,
  type Texture,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { BinaryMessage } from "../engine/binary_message";

const markColour = 0xf0144c;
const hiddenOpacity = 0.3; // of what lies behind a surface

/** Lights up points, lines and triangles of a mesh. What the surface hides shines through it. */
export class Marks {
  readonly object = new Group();
  /** The positions of all of them, relative to the mesh's offset, 3 numbers each. */
  private positions = new Float32Array();
  private triangles = new Float32Array();
  private disc: Texture | undefined;

  get isEmpty(): boolean {
    return this.positions.length === 0;
  }

  /** Shows the places of a message of kind `marks`, and removes earlier ones. */
  show(message: BinaryMessage): void {
    this.clear();
    const [points, lines, triangles] = ["points", "lines", "triangles"].map((name) => message.floats(name) ?? new Float32Array());
    this.object.position.fromArray(message.header.offset ?? [0, 0, 0]);
    if (triangles !== undefined && triangles.length > 0) this.addTriangles(triangles);
    if (lines !== undefined && lines.length > 0) this.addLines(lines);
    if (points !== undefined && points.length > 0) this.addPoints(points);
    this.positions = joined([points, lines, triangles]);
    this.triangles = joined([triangles]);
  }

  /** Returns the mean normal of the triangles; undefined without triangles, or if they face all ways. */
  facing(): Vector3 | undefined {
    const sum = new Vector3();
    const corners = [new Vector3(), new Vector3(), new Vector3()] as const;
    let all = 0;
    for (let at = 0; at + 8 < this.triangles.length; at += 9) {
      corners.forEach((corner, k) => corner.fromArray(this.triangles, at + 3 * k));
      const normal = corners[1].sub(corners[0]).cross(corners[2].sub(corners[0]));
      all += normal.length();
      sum.add(normal);
    }
    return sum.length() > 0.4 * all ? sum.normalize() : undefined;
  }

  clear(): void {
    for (const drawn of this.object.children as Mesh[]) {
      drawn.geometry.dispose();
      (drawn.material as Material).dispose();
    }
    this.object.clear();
    this.positions = this.triangles = new Float32Array();
  }

  /** Returns the positions in the coordinates of the object's parent, some thousand at most. */
  sample(): Float32Array {
    const count = this.positions.length / 3;
    const every = Math.max(1, Math.floor(count / 8000));
    const found = new Float32Array(3 * Math.ceil(count / every));
    const position = new Vector3();
    for (let i = 0; i < found.length / 3; ++i)
      position.fromArray(this.positions, 3 * every * i).add(this.object.position).toArray(found, 3 * i);
    return found;
  }

  private addTriangles(positions: Float32Array): void {
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(positions, 3));
    const look = { color: markColour, side: DoubleSide };
    const nearer = { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 };
    this.add(new Mesh(geometry, new MeshBasicMaterial({ ...look, ...behind })), 1);
    this.add(new Mesh(geometry, new MeshBasicMaterial({ ...look, ...nearer, transparent: true, opacity: 0.8 })), 2);
  }

  private addLines(positions: Float32Array): void {
    const geometry = new LineSegmentsGeometry().setPositions(positions);
    this.add(new LineSegments2(geometry, new LineMaterial({ color: markColour, linewidth: 3, ...behind })), 3);
    this.add(new LineSegments2(geometry, new LineMaterial({ color: markColour, linewidth: 4 })), 4);
  }

  private addPoints(positions: Float32Array): void {
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(positions, 3));
    this.disc ??= discTexture();
    const look = { color: markColour, sizeAttenuation: false, map: this.disc, alphaTest: 0.5 };
    this.add(new Points(geometry, new PointsMaterial({ ...look, size: 9, ...behind })), 3);
    this.add(new Points(geometry, new PointsMaterial({ ...look, size: 11 })), 4);
  }

  private add(drawn: Mesh | LineSegments2 | Points, order: number): void {
    drawn.frustumCulled = false;
    drawn.renderOrder = order;
    this.object.add(drawn);
  }
}

const behind = { transparent: true, opacity: hiddenOpacity, depthTest: false, depthWrite: false };

function joined(lists: readonly (Float32Array | undefined)[]): Float32Array<ArrayBuffer> {
  const all = new Float32Array(lists.reduce((sum, list) => sum + (list?.length ?? 0), 0));
  let at = 0;
  for (const list of lists) {
    all.set(list ?? [], at);
    at += list?.length ?? 0;
  }
  return all;
}

/** Returns a picture of a disc, for round points. */
function discTexture(): Texture {
  const size = 32;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = size;
  const pen = canvas.getContext("2d");
  if (pen !== null) {
    pen.fillStyle = "white";
    pen.arc(size / 2, size / 2, size / 2 - 1, 0, 2 * Math.PI);
    pen.fill();
  }
  return new CanvasTexture(canvas);
}
