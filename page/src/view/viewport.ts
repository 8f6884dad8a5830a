import { effect, signal } from "@preact/signals";
import {
  ColorManagement,
  Group,
  LinearSRGBColorSpace,
  Matrix4,
  Ray,
  Scene,
  Sphere,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import type { OrthographicCamera, PerspectiveCamera } from "three";
import { MessageKind, type BinaryMessage } from "../engine/binary_message";
import type { ViewSettings } from "../app/view_settings";
import { axes, uprightOf, vectorOf, type Axis } from "../app/upright";
import type { DocumentState } from "../protocol";
import { Background, Ground, themes, type Theme } from "./backdrop";
import { areWithin, aroundOf, samplePositions } from "./framing";
import { Projection } from "./projection";
import type { Legend } from "./surface/heat";
import { Marks } from "./marks";
import { Navigation } from "./navigation";
import { FrameScheduler, type Drawn } from "./frame_scheduler";
import { raycastSurface, verticesInPolygon, verticesNear, type Hit } from "./picking/picking";
import { toPartCoordinates, Parts } from "./parts";
import { PickTree } from "./picking/pick_tree";
import { Pipeline } from "./pipeline";
import type { Polygon } from "./picking/polygon";
import { matrixOfPose } from "./pose_matrix";
import { readPositions } from "./read_back";
import type { Picture } from "./surface/picture";
import { smallPicture, type SmallPicture } from "./small_picture";
import { Surface } from "./surface/surface";
import { uploadToGpu } from "./surface/to_gpu";
import { ViewCube, viewFrom, type Side } from "./view_cube";
import { ViewNotes } from "./view_notes";
import "./view.css";
import { visibleVertices } from "./picking/visibility";
import { lookUniforms, shadings } from "./surface/surface_material";

const largeVertexCount = 200_000; // vertices above which a surface is brought to the GPU in steps

ColorManagement.enabled = false; // colours are specified in display space

/** The 3D view: surfaces by number, the camera, picking and drawing. */
export class Viewport {
  readonly scene = new Scene();
  /** Objects drawn on top of everything: the gizmo. */
  readonly helpers = new Group();
  readonly surfaces = new Map<number, Surface>();
  /** Other shown surfaces and their maps to the world, included in the bounds of the scene. */
  alsoShown: () => [Surface, Matrix4][] = () => [];
  /** The parts beside the model, for grafting. */
  readonly parts = new Parts(this.scene, (surface) => this.forgetTree(surface));
  private readonly marks = new Marks();
  readonly overlay = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  readonly navigation: Navigation;
  private readonly projection: Projection;
  /** Called before each picture. */
  readonly onFrame = new Set<() => void>();
  /** Called after each picture, when the GPU has finished it. */
  readonly onDrawn = new Set<(picture: Drawn) => void>();
  /**
   * Milliseconds from the start of a picture until the GPU has finished it: the median, the last at rest, and in
   * motion.
   */
  readonly timings = signal({ frameMs: 0, restMs: 0, movingMs: 0 });

  /** Resolves when the model is visible. */
  modelVisible: Promise<void> = Promise.resolve();
  /** The meaning of the heat map's colours. */
  readonly legend = signal<Legend | null>(null);
  private replacement: Surface | undefined;

  private readonly trees = new Map<Surface, PickTree>();
  private readonly look = lookUniforms();
  private readonly helpersScene = new Scene();
  private renderer: WebGLRenderer | undefined;
  private host: HTMLElement | undefined;
  private pipeline: Pipeline | undefined;
  private readonly background = new Background();
  private readonly ground = new Ground();
  private readonly notes = new ViewNotes();
  private readonly cube: ViewCube;
  private readonly scheduler = new FrameScheduler(
    () => this.render(),
    (picture, frameMs) => {
      this.timings.value = { frameMs, restMs: this.scheduler.restMs, movingMs: this.scheduler.movingMs };
      for (const call of this.onDrawn) call(picture);
    },
  );
  private boundingSphere = new Sphere(new Vector3(), 1);
  private model = "";
  private fileUp: "y" | "z" = "z";
  private guessedFront: Axis | undefined;
  private posesTimer: ReturnType<typeof setTimeout> | undefined;
  private posesMoveUntil = 0; // time until which handles count as moving

  constructor(readonly settings: ViewSettings) {
    this.helpersScene.add(this.helpers);
    this.scene.add(this.background.mesh, this.ground.mesh);
    this.navigation = new Navigation({
      requestRender: () => this.requestRender(),
      pointUnder: (x, y) => this.pick(x, y)?.point,
      bounds: () => this.boundingSphere,
      fitUnder: (x, y) => this.fitUnder(x, y),
    });
    this.projection = new Projection(this.navigation, () => this.canvas);
    this.cube = new ViewCube(this.navigation, (direction, up) => this.lookAlong(direction, up));
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.navigation.camera;
  }
  get canvas(): HTMLCanvasElement {
    if (this.renderer === undefined) throw new Error("the view is not attached yet");
    return this.renderer.domElement;
  }
  /** The model. Parts are shown beside it. */
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
    const renderer = new WebGLRenderer({ antialias: false, powerPreference: "high-performance" });
    renderer.outputColorSpace = LinearSRGBColorSpace;
    renderer.autoClear = false;
    renderer.debug.checkShaderErrors = import.meta.env.DEV; // checking would wait for the shader compiler
    this.renderer = renderer;
    this.pipeline = new Pipeline(renderer);
    this.host = host;
    Object.assign(renderer.domElement.style, {
      display: "block",
      position: "absolute",
      inset: "0",
      width: "100%",
      height: "100%",
    });
    Object.assign(this.overlay.style, {
      position: "absolute",
      inset: "0",
      width: "100%",
      height: "100%",
      pointerEvents: "none",
      overflow: "hidden",
    });
    host.append(renderer.domElement, this.overlay, this.cube.element, this.cube.menu, this.notes.notes, this.notes.legend);
    this.cube.element.hidden = this.main === undefined;
    effect(() => this.notes.showLegend(this.legend.value));
    this.navigation.attach(host);
    new ResizeObserver(() => this.requestRender()).observe(host);
    this.followSettings();
  }

  /** Handles a binary message of the engine. */
  show(message: BinaryMessage): void {
    if (message.kind === MessageKind.mesh && message.header.role === "part") this.addPart(this.surfaceFrom(message));
    else if (message.kind === MessageKind.mesh) this.setMesh(this.surfaceFrom(message));
    const surface = this.surfaceOf(message.header.mesh);
    if (message.kind === MessageKind.selection) this.deselectOthers(surface);
    if (message.kind === MessageKind.frame) surface?.showFrame(message);
    if (message.kind === MessageKind.weights && this.renderer !== undefined) surface?.setWeights(message, this.renderer);
    if (message.kind === MessageKind.selection) surface?.setSelection(message.indices("vertices") ?? new Uint32Array());
    if (message.kind === MessageKind.roles) surface?.setRoles(message);
    if (message.kind === MessageKind.marks) this.showMarks(message);
    this.requestRender();
  }

  /** Makes a surface with the common settings. It is not added to the scene. */
  surfaceFrom(message: BinaryMessage): Surface {
    const shared = [...message.sharedPictures()].flatMap(([number, [mesh, there]]): [number, Picture][] => {
      const picture = this.surfaceOf(mesh)?.pictures.get(there);
      return picture === undefined ? [] : [[number, picture]];
    });
    const surface = new Surface(message, this.look, new Map(shared));
    surface.onChange = () => this.requestRender();
    return surface;
  }

  /**
   * Shows a surface instead of the model, with the model's settings; undefined: the model itself. The caller disposes
   * of the surface.
   */
  showReplacement(surface: Surface | undefined): void {
    if (this.replacement !== undefined && this.replacement !== surface) this.forgetTree(this.replacement);
    this.replacement = surface;
    if (surface !== undefined) {
      this.followLegend(surface);
      this.applyTo(surface);
      const { wireframe, heatMap } = this.settings;
      if (wireframe.value || heatMap.value === "detail") this.treeOf(surface); // its worker finds the edges
    }
    this.legend.value = (surface ?? this.main)?.heat.legend ?? null;
  }

  private followLegend(surface: Surface): void {
    surface.onChange = () => {
      if (surface === (this.replacement ?? this.main)) this.legend.value = surface.heat.legend;
      this.requestRender();
    };
  }

  /** Returns the surface of the model or of a part. */
  surfaceOf(mesh: number): Surface | undefined {
    return this.surfaces.get(mesh) ?? this.parts.get(mesh)?.surface;
  }

  /** Lights up the places of a message of kind `marks`, and moves the camera to them. */
  private showMarks(message: BinaryMessage): void {
    const { mesh } = message.header;
    this.marks.show(message);
    (this.parts.get(mesh)?.loops ?? this.scene).add(this.marks.object);
    this.marks.object.updateWorldMatrix(true, false);
    const surface = this.surfaceOf(mesh);
    if (this.marks.isEmpty || surface === undefined) return;
    const places = samplePositions([[this.marks, this.parts.get(mesh)?.matrixWorld ?? new Matrix4()]]);
    const towards = this.marks.facing() ?? this.outwardAt(places);
    if (towards !== undefined) this.lookAlong(towards.negate());
    this.navigation.fit(places, 0.09 * surface.box.diagonal);
  }
  /** Returns the direction from the middle of everything to places on one side of it; undefined if they are all around. */
  private outwardAt(places: Float32Array): Vector3 | undefined {
    const { centre, radius } = aroundOf(places);
    const outward = centre.sub(this.boundingSphere.center);
    const isOnOneSide = radius < 0.3 * this.boundingSphere.radius && outward.length() > 0.1 * this.boundingSphere.radius;
    return isOnOneSide ? outward : undefined;
  }
  hideMarks(): void {
    this.marks.clear();
    this.requestRender();
  }

  private deselectOthers(surface: Surface | undefined): void {
    const all = [...this.surfaces.values(), ...[...this.parts.all()].map((part) => part.surface)];
    for (const other of all) if (other !== surface) other.setSelection(new Uint32Array());
  }

  private forgetTree(surface: Surface): void {
    this.trees.get(surface)?.dispose();
    this.trees.delete(surface);
  }

  /** Takes the handles' poses from the document, for handles that `showPoses` is not given. */
  setDocument(state: DocumentState): void {
    const model = [state.file, state.name, state.front].join(" "); // a sample has no file
    if (model !== this.model) {
      const was = this.navigation.upright;
      this.model = model;
      this.fileUp = state.up;
      this.guessedFront = state.front;
      this.setUp();
      if (was !== this.navigation.upright) this.fit("all", false);
    }
    const surface = this.surfaces.get(state.model.mesh) ?? this.main;
    if (surface === undefined) return;
    const poses = new Map<string, Matrix4>();
    for (const handle of state.handles) {
      const pose = handle.matrix === undefined ? handle.pose : { matrix: handle.matrix };
      const matrix = matrixOfPose(pose, handle.pivot);
      if (matrix !== undefined) poses.set(handle.name, matrix);
    }
    surface.linear.committed = poses;
  }

  /**
   * Notes that a request with poses was sent. The returned function must be called with the frame number in its answer,
   * or with 0 if there is none.
   */
  beginPoseRequest(): (pose: number) => void {
    return this.main?.linear.beginRequest() ?? (() => undefined);
  }

  /** Shows temporary maps of handles (4×4, world) in the vertex shader. Returns false without weights. */
  showPoses(poses: ReadonlyMap<string, Matrix4>): boolean {
    this.posesMoveUntil = performance.now() + 250;
    clearTimeout(this.posesTimer);
    this.posesTimer = setTimeout(() => this.requestRender(), 260);
    return this.main?.showPoses(poses) ?? false;
  }

  /** Draws surfaces apart from the scene, as the camera sees them. Returns a square picture as a data URL. */
  smallPicture(picture: SmallPicture): Promise<string> {
    if (this.renderer === undefined) return Promise.reject(new Error("the view is not attached yet"));
    return smallPicture(this.renderer, picture, this.navigation.orientation());
  }

  /** Reads the positions that the vertex shader gives the model's vertices (3 numbers each, relative to its offset). */
  readPositions(): Promise<Float32Array> {
    if (this.renderer === undefined || this.main === undefined) return Promise.reject(new Error("nothing is shown"));
    return readPositions(this.renderer, this.main);
  }

  /** Returns the hit under a point of the page. */
  pick(clientX: number, clientY: number): Hit | undefined {
    const ray = this.rayAt(clientX, clientY);
    let nearest: (Hit & { distance: number }) | undefined;
    for (const surface of this.surfaces.values()) {
      if (!surface.object.visible) continue;
      const hit = raycastSurface(surface, this.treeOf(surface), ray);
      if (hit !== undefined && !(hit.distance > (nearest?.distance ?? Infinity))) nearest = hit;
    }
    for (const part of this.parts.shown()) {
      const hit = part.raycast(ray, this.treeOf(part.surface));
      if (hit !== undefined && !(hit.distance > (nearest?.distance ?? Infinity))) nearest = hit;
    }
    return nearest;
  }

  /**
   * Returns the vertices in a polygon (pixels of the page). Without `through`: only those that face the camera and are
   * not hidden.
   */
  verticesInPolygon(surface: Surface, polygon: Polygon, through: boolean): Uint32Array {
    const found = verticesInPolygon(surface, this.projection.toClip(surface), polygon);
    if (through) return found;
    return visibleVertices(surface, found, this.treeOf(surface), this.projection.projector());
  }

  /**
   * Returns the vertices in a ball around a hit. Without `through`: only those that face the camera and are connected
   * to the hit.
   */
  verticesNear(surface: Surface, hit: Hit, radius: number, through: boolean): Uint32Array {
    const part = this.parts.of(surface);
    const cameraPosition = this.projection.cameraPositionFor(hit.point, this.boundingSphere.radius);
    const inWorld = { hit, radius, cameraPosition };
    const own = part === undefined ? inWorld : toPartCoordinates(part, hit, radius, cameraPosition);
    return verticesNear(own.hit, this.treeOf(surface), own.radius, through, own.cameraPosition);
  }

  /** Returns the world length of a CSS pixel at the depth of `point`. */
  worldPerPixel(point: Vector3): number {
    return this.projection.worldPerPixel(point);
  }
  /** Returns the point of the page of a world point, and whether it is `behind` the camera. */
  project(point: Vector3): { x: number; y: number; behind: boolean } {
    return this.projection.project(point);
  }
  /** Returns the world ray through a point of the page. */
  rayAt(clientX: number, clientY: number): Ray {
    return this.projection.rayAt(clientX, clientY);
  }

  /** Whether the camera is at rest and what it sees is drawn; an antialiased picture may follow. */
  get isAtRest(): boolean {
    return !this.navigation.isMoving && performance.now() >= this.posesMoveUntil && this.scheduler.isIdle;
  }
  /** Whether the camera is at rest and the last picture is drawn, with antialiasing where it is quick enough. */
  get isFinished(): boolean {
    return this.isAtRest && this.scheduler.isFinished;
  }

  /** Frames everything, or some vertices of the model as shown. */
  fit(what: "all" | Uint32Array = "all", animated = true): void {
    const { main } = this;
    if (main === undefined) return;
    if (what !== "all" && what.length > 0) {
      this.navigation.fit(main.sample(what), 0.02 * main.box.diagonal, animated);
      return;
    }
    this.updateBounds();
    this.navigation.fit(samplePositions(this.allShown()), 1e-6 * main.box.diagonal, animated);
  }

  /** Returns whether vertices of a surface are in the picture, except a few. */
  isInView(surface: Surface, vertices: Uint32Array): boolean {
    return areWithin(surface.sample(vertices), this.canvas.getBoundingClientRect(), (point) => this.project(point));
  }

  /** Looks along a world direction. */
  lookAlong(direction: Vector3, up?: Vector3): void {
    this.navigation.lookAlong(direction, up);
  }

  /** Looks at the model from one side of the turntable. */
  lookFrom(side: Side): void {
    const { direction, up } = viewFrom(side, this.navigation.axes());
    this.lookAlong(direction, up);
  }

  /** The element beside the view cube that holds its menu. */
  get cubeMenu(): HTMLElement {
    return this.cube.menu;
  }

  /** Returns the side of the model that faces the viewer most. */
  sideSeen(): Axis {
    const towardsCamera = new Vector3(0, 0, 1).applyQuaternion(this.navigation.orientation());
    const facing = (axis: Axis) => towardsCamera.dot(new Vector3(...vectorOf(axis)));
    return axes.reduce((best, axis) => (facing(axis) > facing(best) ? axis : best));
  }

  requestRender(): void {
    this.scheduler.request();
  }

  private render(): void {
    const { renderer, host, pipeline, settings } = this;
    if (renderer === undefined || pipeline === undefined || host === undefined) return;
    if (host.clientWidth === 0 || host.clientHeight === 0) return; // a camera without proportions has no place
    if (this.main !== undefined && this.main.object.parent === null) return; // being sent to the GPU
    const start = performance.now();
    this.resize(renderer, host);
    this.navigation.update(host.clientWidth / host.clientHeight);
    for (const call of this.onFrame) call();
    this.cube.update();
    this.notes.update(this.worldPerPixel(this.navigation.target), this.main !== undefined, settings.unit.value);
    const moving = this.navigation.isMoving || start < this.posesMoveUntil;
    const mayReduce = settings.lessWhileMoving.value;
    const coarse = this.scheduler.wantsCoarse(moving, mayReduce);
    for (const surface of this.surfaces.values()) surface.showCoarse(coarse);
    for (const part of this.parts.shown()) part.surface.showCoarse(coarse);
    this.replacement?.showCoarse(coarse);
    const detail = this.scheduler.detail(moving, mayReduce, settings.ambientOcclusion.value && this.main !== undefined);
    this.look.cavity.value = detail.occlusion ? 1 : 0;
    const { viewHeight, distance, orthographic } = this.navigation;
    pipeline.render(
      this.scene,
      this.camera,
      detail,
      0.09 * this.boundingSphere.radius,
      orthographic ? viewHeight : viewHeight / distance,
    );
    renderer.clearDepth();
    renderer.render(this.helpersScene, this.camera);
    this.scheduler.finish(renderer, start, moving);
  }

  /** Resizes the canvas right before a picture. While the GPU draws, resizing would block. */
  private resize(renderer: WebGLRenderer, { clientWidth, clientHeight }: HTMLElement): void {
    const ratio = Math.min(2, window.devicePixelRatio);
    const size = renderer.getSize(new Vector2());
    if (size.x === clientWidth && size.y === clientHeight && renderer.getPixelRatio() === ratio) return;
    renderer.setPixelRatio(ratio);
    renderer.setSize(clientWidth, clientHeight, false);
  }

  private followSettings(): void {
    const { settings, look } = this;
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    const isDark = signal(dark.matches);
    dark.addEventListener("change", () => (isDark.value = dark.matches));
    effect(() => {
      const theme = settings.theme.value === "system" ? (isDark.value ? "dark" : "light") : settings.theme.value;
      this.setTheme(themes[theme]);
      look.shading.value = shadings[settings.shading.value];
      look.showRoles.value = settings.showRoles.value;
      this.navigation.orthographic = settings.orthographic.value;
      // All signals are read here, so that the effect depends on them even before anything is shown.
      const { before, wireframe, heatMap, stretchOf, ambientOcclusion } = settings;
      for (const one of [before, wireframe, heatMap, stretchOf, ambientOcclusion]) void one.value;
      this.ground.mesh.visible = settings.grid.value;
      for (const surface of this.surfaces.values()) this.applyTo(surface);
      for (const part of this.parts.all()) this.applyShading(part.surface);
      if (this.replacement !== undefined) this.showReplacement(this.replacement);
      this.requestRender();
    });
    let model = settings.model.value;
    effect(() => {
      settings.up.value;
      settings.front.value;
      settings.unit.value;
      const was = this.navigation.upright;
      this.setUp();
      if (model !== settings.model.value && was !== this.navigation.upright) this.fit("all", false);
      model = settings.model.value;
      this.requestRender();
    });
  }

  private setTheme(theme: Theme): void {
    this.host?.classList.toggle("view-dark", theme === themes.dark);
    this.background.setTheme(theme);
    this.ground.setTheme(theme);
    this.look.wireColour.value.copy(theme.wire);
    this.look.boundaryColour.value.copy(theme.boundary);
  }

  private applyTo(surface: Surface): void {
    const { settings } = this;
    surface.setBefore(settings.before.value);
    surface.showWire(settings.wireframe.value);
    surface.heat.show(settings.heatMap.value, settings.stretchOf.value);
    this.applyShading(surface);
  }

  private addPart(surface: Surface): void {
    this.parts.add(surface);
    this.applyShading(surface);
  }

  private applyShading(surface: Surface): void {
    const textured = this.settings.shading.value === "texture";
    if (textured) surface.needRest();
    surface.showTextures(textured);
  }

  /** Sets how the model stands: as chosen, or with the upper side of the file format and the front guessed from the shape. */
  private setUp(): void {
    const set = this.settings.up.value;
    const { value: chosen } = this.settings.front;
    const upright = set === "auto" ? uprightOf(this.fileUp, chosen ?? this.guessedFront) : uprightOf(set, chosen);
    const { up, front } = this.navigation.upright;
    if (up !== upright.up || front !== upright.front) this.navigation.upright = upright;
    this.fitGround();
  }

  /** Places the ground below the model's lowest point. */
  private fitGround(): void {
    const { main } = this;
    if (main === undefined) return;
    const up = this.navigation.axes()[2];
    const middle = main.box.min.clone().add(main.box.max).multiplyScalar(0.5);
    const side = up.x + up.y + up.z > 0 ? main.box.min : main.box.max;
    for (const k of ["x", "y", "z"] as const) if (up[k] !== 0) middle[k] = side[k];
    this.ground.fitTo(middle.add(main.object.position), up, main.box.diagonal);
  }

  private setMesh(surface: Surface): void {
    const first = this.main === undefined;
    const before = this.main?.box;
    for (const old of this.surfaces.values()) {
      this.scene.remove(old.object);
      this.forgetTree(old);
      old.dispose();
    }
    this.surfaces.clear();
    this.surfaces.set(surface.id, surface);
    ++this.parts.changed.value;
    this.modelVisible = this.showWhenUploaded(surface);
    this.followLegend(surface);
    this.applyTo(surface);
    if (this.replacement === undefined) this.legend.value = surface.heat.legend; // replaces the last model's legend
    this.cube.element.hidden = false;
    this.updateBounds();
    this.fitGround();
    const similar =
      before !== undefined && before.diagonal > 0 && Math.abs(surface.box.diagonal / before.diagonal - 1) < 0.2;
    this.navigation.update(this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
    if (first || !similar) this.fit("all", false);
  }

  /** Shows a new surface once its arrays are on the GPU. Large ones are brought there one array at a time. */
  private async showWhenUploaded(surface: Surface): Promise<void> {
    if (surface.vertexCount > largeVertexCount && this.renderer !== undefined) {
      this.scheduler.expectLargeSurface();
      const isWanted = () => this.surfaces.get(surface.id) === surface;
      await uploadToGpu(surface, this.renderer, this.background.mesh.material, this.camera, isWanted);
    }
    if (this.surfaces.get(surface.id) !== surface) return;
    this.scene.add(surface.object);
    await this.nextPicture();
    if (this.surfaces.get(surface.id) === surface) this.treeOf(surface); // now, as its worker slows uploads down
  }

  private nextPicture(): Promise<void> {
    this.requestRender();
    return new Promise((resolve) => {
      const drawn = () => (this.onDrawn.delete(drawn), resolve());
      this.onDrawn.add(drawn);
    });
  }

  /** Returns all visible surfaces and their maps to the world. */
  private allShown(): [Surface, Matrix4][] {
    const model = [...this.surfaces.values()].filter((surface) => surface.object.visible);
    const parts = this.parts.shown().map((part): [Surface, Matrix4] => [part.surface, part.matrixWorld]);
    return [...model.map((surface): [Surface, Matrix4] => [surface, new Matrix4()]), ...parts, ...this.alsoShown()];
  }

  /** Computes the bounding sphere of everything shown, for navigation and framing. */
  updateBounds(): void {
    const spheres = this.allShown().map(([surface, matrix]) => surface.sphere().applyMatrix4(matrix));
    this.boundingSphere = spheres[0]?.clone() ?? new Sphere(new Vector3(), 1);
    for (const sphere of spheres.slice(1)) this.boundingSphere.union(sphere);
  }

  /** Returns the pick tree of a surface, and makes it on the first call. */
  treeOf(surface: Surface): PickTree {
    const known = this.trees.get(surface) ?? new PickTree(surface);
    this.trees.set(surface, known);
    return known;
  }

  private fitUnder(clientX: number, clientY: number): void {
    const hit = this.pick(clientX, clientY);
    if (hit === undefined) return this.fit();
    this.navigation.fit(Float32Array.from(hit.point.toArray()), 0.12 * hit.surface.box.diagonal);
  }
}
