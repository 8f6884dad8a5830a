import { Color, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { FrameKind, type BinaryFrame } from "../engine/binary_frame";
import type { ViewSettings } from "../app/view_settings";
import { Surface } from "./surface";

/** The three-dimensional view: surfaces by their numbers, the camera, and what is picked and drawn there. */
export class Viewport {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  readonly surfaces = new Map<number, Surface>();
  private renderer: WebGLRenderer | undefined;
  private controls: OrbitControls | undefined;
  private scheduled = false;

  constructor(readonly settings: ViewSettings) {}

  attach(host: HTMLElement): void {
    const renderer = new WebGLRenderer({ antialias: true });
    this.renderer = renderer;
    this.scene.background = new Color(0x20252b);
    host.append(renderer.domElement);
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.addEventListener("change", () => this.requestRender());
    new ResizeObserver(() => {
      renderer.setSize(host.clientWidth, host.clientHeight);
      this.camera.aspect = host.clientWidth / host.clientHeight;
      this.camera.updateProjectionMatrix();
      this.requestRender();
    }).observe(host);
  }

  /** Shows what the engine sent. */
  show(frame: BinaryFrame): void {
    if (frame.kind === FrameKind.mesh) this.setMesh(new Surface(frame));
    const surface = this.surfaces.get(frame.header.mesh);
    if (frame.kind === FrameKind.frame) surface?.showFrame(frame);
    if (frame.kind === FrameKind.weights) surface?.setWeights(frame);
    if (frame.kind === FrameKind.selection) surface?.setSelection(frame.indices("vertices") ?? new Uint32Array());
    if (frame.kind === FrameKind.roles) surface?.setRoles(frame);
    this.requestRender();
  }

  /** The model; absent: nothing is open. */
  get main(): Surface | undefined {
    return [...this.surfaces.values()][0];
  }

  /** Where a place of the world is on the page. */
  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.renderer?.domElement.getBoundingClientRect() ?? new DOMRect();
    const at = point.clone().project(this.camera);
    return { x: box.x + ((at.x + 1) / 2) * box.width, y: box.y + ((1 - at.y) / 2) * box.height, behind: at.z > 1 };
  }

  requestRender(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.renderer?.render(this.scene, this.camera);
    });
  }

  private setMesh(surface: Surface): void {
    for (const old of this.surfaces.values()) {
      this.scene.remove(old.object);
      old.dispose();
    }
    this.surfaces.clear();
    this.surfaces.set(surface.id, surface);
    this.scene.add(surface.object);
    surface.object.geometry.computeBoundingSphere();
    const sphere = surface.object.geometry.boundingSphere;
    if (sphere === null) return;
    this.camera.position.set(0, 0, 3.5 * sphere.radius).add(sphere.center).add(surface.object.position);
    this.camera.near = sphere.radius / 100;
    this.camera.far = sphere.radius * 100;
    this.camera.updateProjectionMatrix();
    this.controls?.target.copy(sphere.center).add(surface.object.position);
    this.controls?.update();
  }
}
