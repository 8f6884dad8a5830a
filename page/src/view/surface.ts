import { BufferAttribute, BufferGeometry, Mesh, MeshMatcapMaterial } from "three";
import type { BinaryFrame } from "../engine/binary_frame";
import type { Pose } from "../protocol";

/** One mesh as it is shown: at rest, deformed by streamed frames, or by its handles in the vertex shader. */
export class Surface {
  readonly object: Mesh;
  readonly id: number;
  readonly vertexCount: number;
  /** Where the vertices are at rest, and where they are shown, relative to `offset` (3 numbers a vertex). */
  readonly rest: Float32Array;
  readonly positions: Float32Array;
  readonly offset: readonly [number, number, number];
  private readonly geometry = new BufferGeometry();

  constructor(frame: BinaryFrame) {
    this.id = frame.header.mesh;
    this.rest = frame.floats("positions") ?? new Float32Array();
    this.positions = this.rest.slice();
    this.vertexCount = this.rest.length / 3;
    this.offset = frame.header.offset ?? [0, 0, 0];
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(frame.floats("normals") ?? new Float32Array(), 3));
    this.geometry.setIndex(new BufferAttribute(frame.indices("triangles") ?? new Uint32Array(), 1));
    this.object = new Mesh(this.geometry, new MeshMatcapMaterial({ color: 0xd8cfc4 }));
    this.object.position.set(...this.offset);
  }

  /** Kind `frame`: positions, of all vertices or of those that it lists. */
  showFrame(frame: BinaryFrame): void {
    const sent = frame.floats("positions") ?? new Float32Array();
    const vertices = frame.indices("vertices");
    if (vertices === undefined) this.positions.set(sent);
    else
      vertices.forEach((v, i) => {
        for (let k = 0; k < 3; ++k) this.positions[3 * v + k] = sent[3 * i + k] ?? 0;
      });
    this.geometry.getAttribute("position").needsUpdate = true;
  }

  /** Kind `weights`: from now on `showPoses` moves the mesh in the vertex shader. */
  setWeights(_frame: BinaryFrame): void {}

  /** Handles' poses by name, shown at once where there are weights. Returns whether there are. */
  showPoses(_poses: ReadonlyMap<string, Pose>): boolean {
    return false;
  }

  setSelection(_vertices: Uint32Array): void {}

  /** Kind `roles`: region, fixed part and handles. */
  setRoles(_frame: BinaryFrame): void {}

  dispose(): void {
    this.geometry.dispose();
  }
}
