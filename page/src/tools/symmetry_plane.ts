import { effect } from "@preact/signals";
import { BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineLoop, Mesh, MeshBasicMaterial } from "three";
import { PlaneGeometry, Quaternion, Vector3 } from "three";
import type { Viewport } from "../view/viewport";
import type { HandleControl } from "./handle_control";

/** Draws the plane of symmetry as a faint square through the model. */
export class SymmetryPlane {
  private readonly group = new Group();

  constructor(
    private readonly viewport: Viewport,
    private readonly control: HandleControl,
  ) {
    const look = { color: 0x8f7ee7, transparent: true, depthWrite: false };
    const corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([x, y]) => new Vector3(x, y, 0));
    this.group.add(
      new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial({ ...look, opacity: 0.09, side: DoubleSide })),
      new LineLoop(new BufferGeometry().setFromPoints(corners), new LineBasicMaterial({ ...look, opacity: 0.55 })),
    );
    this.group.visible = false;
    viewport.scene.add(this.group);
    effect(() => this.follow());
  }

  private follow(): void {
    const { plane } = this.control;
    const surface = this.viewport.main;
    this.group.visible = plane !== undefined && surface !== undefined;
    this.viewport.requestRender();
    if (plane === undefined || surface === undefined) return;
    const { center } = surface.sphere();
    const off = center.clone().sub(plane.point).dot(plane.normal);
    this.group.position.copy(center).addScaledVector(plane.normal, -off);
    this.group.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), plane.normal));
    this.group.scale.setScalar(1.1 * surface.box.diagonal);
  }
}
