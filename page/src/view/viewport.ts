import { effect, signal } from "@preact/signals";
import { Box3, Color, ColorManagement, Group, LinearSRGBColorSpace, Matrix4, Ray, Scene, Sphere, Vector2, Vector3, WebGLRenderer } from "three";
import type { OrthographicCamera, PerspectiveCamera } from "three";
import { FrameKind, type BinaryFrame } from "../engine/binary_frame";
import type { ViewSettings } from "../app/view_settings";
import type { DocumentState } from "../protocol";
import { Navigation } from "./navigation";
import { meetSurface, verticesInPolygon, verticesNear, type Hit } from "./picking";
import { PickTree } from "./pick_tree";
import type { Polygon } from "./polygon";
import { matrixOfPose } from "./pose_matrix";
import { readPositions } from "./read_back";
import { Surface } from "./surface";
import { lookUniforms, shadings } from "./surface_material";

ColorManagement.enabled = false; // colours are written as they are shown

/** The three-dimensional view: surfaces by their numbers, the camera, and what is picked and drawn there. */
export class Viewport {
  readonly scene = new Scene();
  /** Drawn on top of everything: the gizmo. */
  readonly helpers = new Group();
  readonly surfaces = new Map<number, Surface>();
  readonly overlay = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  readonly navigation: Navigation;
  /** Called before each picture. */
  readonly onFrame = new Set<() => void>();
  readonly timings = signal({ frameMs: 0 });

  private readonly trees = new Map<Surface, PickTree>();
  private readonly look = lookUniforms();
  private readonly helpersScene = new Scene();
  private renderer: WebGLRenderer | undefined;
  private host: HTMLElement | undefined;
  private scheduled = false;
  private ball = new Sphere(new Vector3(), 1);
  private readonly recent: number[] = [];

  constructor(readonly settings: ViewSettings) {
    this.helpersScene.add(this.helpers);
    this.navigation = new Navigation({
      requestRender: () => this.requestRender(),
      placeUnder: (x, y) => this.pick(x, y)?.point,
      bounds: () => this.ball,
      fitUnder: (x, y) => this.fitUnder(x, y),
    });
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.navigation.camera;
  }
  get canvas(): HTMLCanvasElement {
    if (this.renderer === undefined) throw new Error("the view is not attached yet");
    return this.renderer.domElement;
  }
  /** The model; parts come beside it. */
  get main(): Surface | undefined {
    return this.surfaces.values().next().value;
  }
  get orthographic(): boolean {
    return this.settings.orthographic.value;
  }
  set orthographic(is: boolean) {
    this.settings.orthographic.value = is;
  }

  attach(host: HTMLElement): void {
    const renderer = new WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    renderer.outputColorSpace = LinearSRGBColorSpace;
    renderer.autoClear = false;
    this.renderer = renderer;
    this.host = host;
    Object.assign(renderer.domElement.style, { display: "block", position: "absolute", inset: "0" });
    Object.assign(this.overlay.style, { position: "absolute", inset: "0", width: "100%", height: "100%", pointerEvents: "none", overflow: "hidden" });
    host.append(renderer.domElement, this.overlay);
    this.navigation.attach(host);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
    this.followSettings();
  }

  /** Shows what the engine sent. */
  show(frame: BinaryFrame): void {
    if (frame.kind === FrameKind.mesh) this.setMesh(new Surface(frame, this.look));
    const surface = this.surfaces.get(frame.header.mesh);
    if (frame.kind === FrameKind.frame) surface?.showFrame(frame);
    if (frame.kind === FrameKind.weights && this.renderer !== undefined) surface?.setWeights(frame, this.renderer);
    if (frame.kind === FrameKind.selection) surface?.setSelection(frame.indices("vertices") ?? new Uint32Array());
    if (frame.kind === FrameKind.roles) surface?.setRoles(frame);
    this.requestRender();
  }

  /** Where the document has the handles: for those that `showPoses` is not told of. */
  setDocument(state: DocumentState): void {
    const surface = this.surfaces.get(state.model.mesh) ?? this.main;
    if (surface === undefined) return;
    const poses = new Map<string, Matrix4>();
    for (const handle of state.handles) {
      const matrix = matrixOfPose(handle.pose, handle.pivot);
      if (matrix !== undefined) poses.set(handle.name, matrix);
    }
    surface.linear.committed = poses;
  }

  /** A request with poses is sent; what is returned is to be told the number in its answer (0: there is none). */
  posesAsked(): (pose: number) => void {
    return this.main?.linear.asked() ?? (() => undefined);
  }

  /** Handles' maps for now (world, 4x4), by the vertex shader. Returns whether there are weights for that. */
  showPoses(poses: ReadonlyMap<string, Matrix4>): boolean {
    return this.main?.showPoses(poses) ?? false;
  }

  /** Where the vertex shader puts the model's vertices (3 numbers each, relative to its offset). */
  readPositions(): Promise<Float32Array> {
    if (this.renderer === undefined || this.main === undefined) return Promise.reject(new Error("nothing is shown"));
    return readPositions(this.renderer, this.main);
  }

  /** What is shown under a place of the page. */
  pick(clientX: number, clientY: number): Hit | undefined {
    const ray = this.rayAt(clientX, clientY);
    let nearest: (Hit & { distance: number }) | undefined;
    for (const surface of this.surfaces.values()) {
      const hit = meetSurface(surface, this.treeOf(surface), ray);
      if (hit !== undefined && !(hit.distance > (nearest?.distance ?? Infinity))) nearest = hit;
    }
    return nearest;
  }

  /** Vertices in a polygon (pixels of the page); not `through`: those that face the eye and are not hidden. */
  verticesInPolygon(surface: Surface, polygon: Polygon, through: boolean): Uint32Array {
    const projection = this.projectionOf(surface);
    if (through) return verticesInPolygon(surface, projection, polygon);
    return verticesInPolygon(surface, projection, polygon, this.visibility(surface));
  }

  /** Vertices in a ball around a hit; not `through`: those that face the eye and hang together with the hit. */
  verticesNear(surface: Surface, hit: Hit, radius: number, through: boolean): Uint32Array {
    return verticesNear(hit, this.treeOf(surface), radius, through, this.eyeFor(hit.point));
  }

  /** Of the world, for a pixel of the page at the depth of `point`. */
  worldPerPixel(point: Vector3): number {
    const height = Math.max(1, this.host?.clientHeight ?? 1);
    const { navigation } = this;
    if (navigation.orthographic) return navigation.viewHeight / height;
    const depth = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
    return (Math.abs(depth) * navigation.viewHeight) / (navigation.distance * height);
  }

  /** Where a place of the world is on the page; `behind` the camera. */
  project(point: Vector3): { x: number; y: number; behind: boolean } {
    const box = this.box();
    const behind = point.clone().applyMatrix4(this.camera.matrixWorldInverse).z > 0 && !this.navigation.orthographic;
    const p = point.clone().project(this.camera);
    return { x: box.left + 0.5 * (p.x + 1) * box.width, y: box.top + 0.5 * (1 - p.y) * box.height, behind };
  }

  /** The ray of the world through a place of the page. */
  rayAt(clientX: number, clientY: number): Ray {
    const box = this.box();
    const at = new Vector2((2 * (clientX - box.left)) / box.width - 1, 1 - (2 * (clientY - box.top)) / box.height);
    const far = new Vector3(at.x, at.y, 0.5).unproject(this.camera);
    if (!this.navigation.orthographic) {
      const origin = this.camera.position.clone();
      return new Ray(origin, far.sub(origin).normalize());
    }
    const along = new Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
    return new Ray(new Vector3(at.x, at.y, -1).unproject(this.camera), along);
  }

  /** Frames everything, or some vertices of the model, as they are shown. */
  fit(what: "all" | Uint32Array = "all", animated = true): void {
    if (what === "all" || what.length === 0) {
      this.measure();
      this.navigation.fit(this.ball, animated);
      return;
    }
    const { main } = this;
    if (main === undefined) return;
    const box = new Box3();
    for (const v of what) box.expandByPoint(main.place(v));
    const sphere = box.getBoundingSphere(new Sphere());
    sphere.radius = Math.max(1.3 * sphere.radius, 0.02 * main.box.diagonal);
    this.navigation.fit(sphere, animated);
  }

  /** Looks along a direction of the world. */
  lookAlong(direction: Vector3, up?: Vector3): void {
    this.navigation.lookAlong(direction, up);
  }

  requestRender(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.render();
    });
  }

  private render(): void {
    const { renderer, host } = this;
    if (renderer === undefined || host === undefined || host.clientHeight === 0) return;
    const start = performance.now();
    this.navigation.update(host.clientWidth / host.clientHeight);
    for (const call of this.onFrame) call();
    renderer.clear();
    renderer.render(this.scene, this.camera);
    renderer.clearDepth();
    renderer.render(this.helpersScene, this.camera);
    this.note(performance.now() - start);
  }

  private note(ms: number): void {
    this.recent.push(ms);
    if (this.recent.length > 31) this.recent.shift();
    const sorted = [...this.recent].sort((a, b) => a - b);
    this.timings.value = { frameMs: sorted[sorted.length >> 1] ?? 0 };
  }

  private resize(): void {
    const { renderer, host } = this;
    if (renderer === undefined || host === undefined) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    renderer.setSize(host.clientWidth, host.clientHeight);
    this.requestRender();
  }

  private followSettings(): void {
    const { settings, look } = this;
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    const isDark = signal(dark.matches);
    dark.addEventListener("change", () => (isDark.value = dark.matches));
    effect(() => {
      const theme = settings.theme.value === "system" ? (isDark.value ? "dark" : "light") : settings.theme.value;
      this.scene.background = new Color(theme === "dark" ? 0x22262c : 0xe9ebee);
      look.shading.value = shadings[settings.shading.value];
      look.showRoles.value = settings.showRoles.value;
      this.navigation.orthographic = settings.orthographic.value;
      for (const surface of this.surfaces.values()) surface.setBefore(settings.before.value);
      this.requestRender();
    });
  }

  private setMesh(surface: Surface): void {
    const first = this.main === undefined;
    const before = this.main?.box;
    for (const old of this.surfaces.values()) {
      this.scene.remove(old.object);
      this.trees.get(old)?.dispose();
      old.dispose();
    }
    this.trees.clear();
    this.surfaces.clear();
    this.surfaces.set(surface.id, surface);
    this.scene.add(surface.object);
    surface.onChange = () => this.requestRender();
    surface.setBefore(this.settings.before.value);
    if (this.settings.shading.value === "texture") surface.needRest();
    this.measure();
    const similar = before !== undefined && before.diagonal > 0 && Math.abs(surface.box.diagonal / before.diagonal - 1) < 0.2;
    if (first || !similar) this.navigation.fit(this.ball, false);
  }

  private measure(): void {
    const spheres = [...this.surfaces.values()].map((surface) => surface.sphere());
    this.ball = spheres[0]?.clone() ?? new Sphere(new Vector3(), 1);
    for (const sphere of spheres.slice(1)) this.ball.union(sphere);
  }

  private treeOf(surface: Surface): PickTree {
    const known = this.trees.get(surface) ?? new PickTree(surface);
    this.trees.set(surface, known);
    return known;
  }

  private fitUnder(clientX: number, clientY: number): void {
    const hit = this.pick(clientX, clientY);
    if (hit === undefined) return this.fit();
    const near = new Sphere(hit.point, 0.12 * hit.surface.box.diagonal);
    this.navigation.fit(near);
  }

  private box(): DOMRect {
    return this.canvas.getBoundingClientRect();
  }

  private eyeFor(point: Vector3): Vector3 {
    if (!this.navigation.orthographic) return this.camera.position.clone();
    const back = new Vector3(0, 0, 1).applyQuaternion(this.camera.quaternion);
    return back.multiplyScalar(1e4 * this.ball.radius).add(point);
  }

  private projectionOf(surface: Surface): { matrix: ArrayLike<number>; box: DOMRect } {
    const { camera } = this;
    const matrix = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const place = new Matrix4().makeTranslation(surface.object.position);
    return { matrix: matrix.multiply(place).elements, box: this.box() };
  }

  /** Which vertices face the eye and are not hidden behind others. */
  private visibility(surface: Surface): (vertex: number) => boolean {
    const tree = this.treeOf(surface);
    const towards = new Vector3();
    const place = new Vector3();
    const normal = new Vector3();
    return (v) => {
      surface.place(v, place);
      towards.copy(this.eyeFor(place)).sub(place).normalize();
      if (normal.fromArray(surface.normals, 3 * v).dot(towards) <= 0) return false;
      const start = place.sub(surface.object.position).addScaledVector(towards, 2e-4 * surface.box.diagonal);
      return tree.raycast(start, towards) === undefined;
    };
  }
}
