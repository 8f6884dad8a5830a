import { DoubleSide, Group, Mesh, ShaderMaterial, Vector3, type Matrix4 } from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import type { BinaryMessage } from "../../engine/binary_message";
import { pairColour } from "../../app/graft/graft_colours";
import type { Surface } from "../surface/surface";

const mostLines = 90; // per pair; more lines would be illegible

/** Lines that show the correspondence, from vertices of the part's loops to their points on the target's loops. */
export class MatchLines {
  readonly object = new Group();
  private line: LineSegments2 | undefined;

  /**
   * `positionOf` returns where a vertex of the source is shown. `targetMatrixWorld` maps the target's coordinates to
   * where it is shown.
   */
  show(message: BinaryMessage, positionOf: (vertex: number) => Vector3 | undefined, targetMatrixWorld: Matrix4): void {
    this.hide();
    const sources = message.indices("line_sources") ?? new Uint32Array();
    const targetPoints = message.floats("line_places") ?? new Float32Array();
    const pairs = message.indices("line_pairs") ?? new Uint32Array();
    const [ox = 0, oy = 0, oz = 0] = message.header.offset ?? [];
    const each = Math.max(1, Math.ceil(sources.length / (mostLines * (1 + Math.max(0, ...pairs)))));
    const ends: number[] = [];
    const colours: number[] = [];
    for (let i = 0; i < sources.length; i += each) {
      const from = positionOf(sources[i] as number);
      if (from === undefined) continue;
      const to = new Vector3().fromArray(targetPoints, 3 * i).add(new Vector3(ox, oy, oz)).applyMatrix4(targetMatrixWorld);
      const colour = pairColour(pairs[i] ?? 0);
      ends.push(...from, ...to);
      colours.push(...colour, ...colour);
    }
    if (ends.length === 0) return;
    const geometry = new LineSegmentsGeometry().setPositions(ends).setColors(colours);
    const material = new LineMaterial({ linewidth: 1.3, vertexColors: true, transparent: true, opacity: 0.5, depthTest: false });
    this.line = new LineSegments2(geometry, material);
    this.line.frustumCulled = false;
    this.object.add(this.line);
  }

  hide(): void {
    if (this.line === undefined) return;
    this.line.removeFromParent();
    this.line.geometry.dispose();
    this.line.material.dispose();
    this.line = undefined;
  }
}

/** Shows a part translucently at its new pose, until the result of the graft arrives. */
export class Ghost {
  readonly object = new Group();
  private mesh: Mesh | undefined;
  private of: Surface | undefined;

  constructor() {
    this.object.matrixAutoUpdate = false;
  }

  show(surface: Surface, at: Matrix4): void {
    if (this.of !== surface) {
      this.hide();
      this.of = surface;
      this.mesh = new Mesh(surface.geometry, ghostMaterial);
      this.mesh.frustumCulled = false;
      this.mesh.renderOrder = 3;
      this.mesh.position.copy(surface.object.position);
      this.object.add(this.mesh);
    }
    this.object.matrix.copy(at);
    this.object.updateMatrixWorld(true);
  }

  hide(): void {
    this.mesh?.removeFromParent();
    this.mesh = undefined;
    this.of = undefined;
  }
}

const ghostMaterial = new ShaderMaterial({
  vertexShader: /* glsl */ `
    varying vec3 shownNormal, seenFrom;
    void main() {
      vec4 seen = modelViewMatrix * vec4(position, 1.0);
      shownNormal = normalMatrix * normal;
      seenFrom = seen.xyz;
      gl_Position = projectionMatrix * seen;
    }`,
  fragmentShader: /* glsl */ `
    varying vec3 shownNormal, seenFrom;
    void main() {
      float facing = abs(dot(normalize(shownNormal), normalize(seenFrom)));
      gl_FragColor = vec4(0.30, 0.55, 0.98, 0.12 + 0.55 * (1.0 - facing) * (1.0 - facing));
    }`,
  transparent: true,
  depthWrite: false,
  side: DoubleSide,
});
