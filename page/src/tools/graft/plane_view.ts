import { effect } from "@preact/signals";
import {
  BufferGeometry, DoubleSide, Float32BufferAttribute, Group, LineBasicMaterial, LineLoop, Mesh, Quaternion, ShaderMaterial, Vector3,
} from "three";
import type { Cut } from "../../app/cuts";
import type { Graft } from "../../app/graft/graft";
import type { Surface } from "../../view/surface/surface";
import type { Viewport } from "../../view/viewport";
import type { PlaneControl } from "./plane_control";

/**
 * Draws the cutting plane as a pane, and tints both sides of the mesh: blue where the normal points, red on the other
 * side.
 */
export class PlaneView {
  private readonly group = new Group();
  private tinted: Surface | undefined;

  constructor(viewport: Viewport, control: PlaneControl, graft: Graft) {
    const corners = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0];
    const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(corners, 3)).setIndex([0, 1, 2, 0, 2, 3]);
    const rim = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(corners, 3));
    const mesh = new Mesh(geometry, pane);
    mesh.renderOrder = 4;
    this.group.add(mesh, new LineLoop(rim, new LineBasicMaterial({ color: 0x3b7cf5 })));
    this.group.visible = false;
    viewport.scene.add(this.group);
    effect(() => {
      const { cutPlane, mode, tool } = graft;
      const { value: cut } = cutPlane;
      this.group.visible = cut !== null && mode.value === "graft" && tool.value === "plane";
      viewport.requestRender();
      const surface = viewport.surfaceOf(cut?.mesh ?? -1);
      this.tint(this.group.visible ? surface : undefined, cut);
      if (cut === null || surface === undefined) return;
      const { point, normal } = control.inWorld(cut);
      const centre = control.centreOfMesh(cut.mesh) ?? point;
      const across = centre.clone().sub(point);
      this.group.position.copy(point).add(across.addScaledVector(normal, -across.dot(normal)));
      this.group.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), normal));
      this.group.scale.setScalar(0.6 * control.sizeOf(cut.mesh));
    });
  }

  private tint(surface: Surface | undefined, cut: Cut | null): void {
    if (this.tinted !== surface) this.tinted?.showCut(null);
    this.tinted = surface;
    surface?.showCut(cut?.plane ?? null);
  }
}

const pane = new ShaderMaterial({
  vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
  fragmentShader:
    "void main() { gl_FragColor = gl_FrontFacing ? vec4(0.23, 0.49, 0.96, 0.32) : vec4(0.90, 0.28, 0.30, 0.32); }",
  transparent: true,
  depthWrite: false,
  side: DoubleSide,
});
