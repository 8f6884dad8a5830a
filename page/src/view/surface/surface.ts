import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh,
  Sphere,
  Vector3,
  Vector4,
  type IUniform,
  type LineSegments,
  type Matrix4,
} from "three";
import type { ShaderMaterial, WebGLRenderer } from "three";
import type { BinaryMessage } from "../../engine/binary_message";
import { deformUniforms } from "./deform_shader";
import { surfaceLines } from "./lines";
import { LinearFrames } from "./linear_frames";
import { Picture } from "./picture";
import { depthInRegion, fixedColour, fixedStrength, handleColour, regionColour, regionStrength, writeTint } from "./roles";
import { Slices } from "./slices";
import { mergedIndices, runsOf, spanOfChange } from "./spans";
import { StreamedFrames } from "./streamed";
import { SurfaceHeat } from "./surface_heat";
import { surfaceMaterial, type LookUniforms } from "./surface_material";
import { TexturedSurface } from "./textured";

/** One mesh as shown: at rest, deformed by streamed frames, or deformed by its handles in the vertex shader. */
export class Surface {
  /** Placed at `offset`; its children draw the surface. */
  readonly object = new Group();
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  readonly geometry = new BufferGeometry();
  readonly id: number;
  readonly vertexCount: number;
  readonly triangles: Uint32Array;
  /** Positions at rest, relative to `offset`, 3 numbers a vertex. */
  readonly rest: Float32Array;
  readonly offset: readonly [number, number, number];
  /** The bounding box at rest, relative to `offset`, in model units. */
  readonly box = { min: new Vector3(), max: new Vector3(), diagonal: 1 };
  /** 255 where a vertex is selected. */
  readonly selection: Uint8Array;
  region: Uint32Array = new Uint32Array();
  fixed: Uint32Array = new Uint32Array();
  readonly handles = new Map<string, Uint32Array>();
  /** Counts changes of `positions`. */
  version = 0;
  readonly deform = deformUniforms();
  readonly linear: LinearFrames;
  readonly own: Record<string, IUniform>;
  readonly slices = new Slices();
  readonly heat = new SurfaceHeat(this);
  readonly uv: Float32Array | undefined;
  readonly colours: Float32Array | undefined;
  /** Its own texture images, by number. */
  readonly pictures: ReadonlyMap<number, Picture>;
  private readonly textured: TexturedSurface | undefined;
  private wantsTextures = false;
  private painted = 0; // counts changes of tint and selection
  private readonly fine: BufferAttribute;
  private coarse: BufferAttribute | undefined;
  private edges: Uint32Array | undefined;
  private wire: LineSegments | undefined;
  private boundary: LineSegments | undefined;
  private wantsWire = false;
  /** Called when a change requires a new picture. */
  onChange: () => void = () => undefined;

  private readonly restNormals: Float32Array;
  private readonly streamed: StreamedFrames;
  private readonly tint: Uint8Array;
  private selected: Uint32Array = new Uint32Array();
  private isBefore = false;

  constructor(
    message: BinaryMessage,
    private readonly look: LookUniforms,
    shared: ReadonlyMap<number, Picture> = new Map(),
  ) {
    this.id = message.header.mesh;
    this.rest = message.floats("positions") ?? new Float32Array();
    this.vertexCount = this.rest.length / 3;
    this.offset = message.header.offset ?? [0, 0, 0];
    this.triangles = message.indices("triangles") ?? new Uint32Array();
    this.restNormals = message.floats("normals") ?? new Float32Array(this.rest.length);
    this.streamed = new StreamedFrames(
      { positions: this.rest, normals: this.restNormals, triangles: this.triangles },
      this.slices,
      { changed: (...vertices) => this.takeChanged(...vertices), shown: (shown) => this.noteShown(shown) },
    );
    this.uv = message.floats("uv");
    this.colours = message.floats("colours");
    this.selection = new Uint8Array(this.vertexCount);
    this.tint = new Uint8Array(4 * this.vertexCount);
    this.measure();
    this.own = {
      checkSize: { value: this.box.diagonal / 40 },
      ...this.heat.uniforms,
      hasCut: { value: false },
      cutPlane: { value: new Vector4() },
    };
    this.linear = new LinearFrames(this.deform, this.geometry, this.vertexCount, this.offset, () => {
      this.deform.linear.value = false;
      this.onChange();
    });
    this.fine = new BufferAttribute(this.triangles, 1);
    this.makeGeometry();
    this.mesh = new Mesh(this.geometry, surfaceMaterial(look, this.deform, this.own));
    this.mesh.frustumCulled = false;
    if (this.uv !== undefined) this.mesh.material.defines["HAS_UV"] = 1;
    if (this.colours !== undefined) this.mesh.material.defines["HAS_COLOURS"] = 1;
    this.pictures = new Map([...message.pictures()].map(([number, file]) => [number, new Picture(file)]));
    this.textured = this.texturesOf(message, new Map([...shared, ...this.pictures]));
    this.object.add(this.mesh);
    this.object.position.set(...this.offset);
  }

  /** The shown positions. While handles move in the shader: the positions that the engine sent last. */
  get positions(): Float32Array {
    return this.isBefore ? this.rest : this.streamed.positions;
  }
  get normals(): Float32Array {
    return this.isBefore ? this.restNormals : this.streamed.normals;
  }
  get triangleCount(): number {
    return this.triangles.length / 3;
  }

  /** Tints the two sides of a plane, given in the mesh's coordinates; null removes the tint. */
  showCut(plane: { point: readonly number[]; normal: readonly number[] } | null): void {
    Object.assign(this.own["hasCut"] ?? {}, { value: plane !== null });
    if (plane === null) return;
    const [x = 0, y = 0, z = 0] = plane.normal;
    const along = [x, y, z].reduce((sum, n, k) => sum + n * ((plane.point[k] ?? 0) - (this.offset[k] ?? 0)), 0);
    Object.assign(this.own["cutPlane"] ?? {}, { value: new Vector4(x, y, z, along) });
  }

  /** Returns the bounding sphere of the box at rest, in world coordinates. */
  sphere(): Sphere {
    const centre = this.box.min.clone().add(this.box.max).multiplyScalar(0.5).add(this.object.position);
    return new Sphere(centre, Math.max(1e-30, 0.5 * this.box.diagonal));
  }

  /** The side lengths of the box at rest. */
  get size(): Vector3 {
    return this.box.max.clone().sub(this.box.min);
  }

  /** Returns the position of a vertex as shown, in world coordinates. */
  positionOf(vertex: number, out = new Vector3()): Vector3 {
    return out.fromArray(this.positions, 3 * vertex).add(this.object.position);
  }

  /** Returns world positions of these vertices, or of some thousand: 3 numbers each. */
  sample(vertices?: Uint32Array): Float32Array {
    const count = vertices?.length ?? this.vertexCount;
    const every = Math.max(1, Math.floor(count / 8000));
    const positions = new Float32Array(3 * Math.ceil(count / every));
    const position = new Vector3();
    let found = 0;
    for (let i = 0; i < count; i += every) {
      this.positionOf(vertices?.[i] ?? i, position);
      if (Number.isFinite(position.x + position.y + position.z)) position.toArray(positions, 3 * found++);
    }
    return positions.subarray(0, 3 * found);
  }

  /** Shows the mesh as the step found it (`before`), or its current state. */
  setBefore(before: boolean): void {
    if (this.isBefore === before) return;
    this.isBefore = before;
    this.useAttributes();
    this.deform.linear.value = !before && this.linear.isShown;
    ++this.version;
    this.heat.renew();
    this.onChange();
  }

  /** Takes a frame of kind `frame`: positions of all vertices or of those that it lists. */
  showFrame(frame: BinaryMessage): void {
    const { pose = 0, accuracy } = frame.header;
    if (frame.indices("vertices")?.length === 0) return this.showRest(frame);
    if (!this.linear.isShown || this.linear.mayReplace(pose, accuracy)) this.streamed.show(frame);
  }

  /** Shows all vertices at rest. */
  private showRest(frame: BinaryMessage): void {
    const wasAtRest = this.streamed.isAtRest;
    this.streamed.showRest();
    if (!wasAtRest) this.useAttributes();
    this.noteShown(frame);
  }

  private noteShown(frame: BinaryMessage): void {
    this.linear.noteStreamed(frame.header.pose ?? 0, frame.header.accuracy);
    ++this.version;
    this.heat.renew();
    this.onChange();
  }

  /** Takes a message of kind `weights`. Once it is on the GPU, `showPoses` moves the surface in the vertex shader. */
  setWeights(message: BinaryMessage, renderer: WebGLRenderer): void {
    this.slices.start("weights", this.linear.setWeights(message, this.handles.keys(), renderer));
  }

  /** Shows handles' maps, given by name, in the vertex shader. Returns false without weights. */
  showPoses(poses: ReadonlyMap<string, Matrix4>): boolean {
    if (!this.linear.show(poses)) return false;
    this.deform.linear.value = !this.isBefore;
    this.onChange();
    return true;
  }

  /** Sets the selection. `vertices` must be ascending. */
  setSelection(vertices: Uint32Array): void {
    for (const v of this.selected) this.selection[v] = 0;
    for (const v of vertices) this.selection[v] = 255;
    this.uploadSpan("selection", spanOfChange(this.selected, vertices));
    this.selected = vertices;
    this.onChange();
  }

  /** Shows vertices as selected or not while a tool paints, until the engine reports the selection. */
  markSelected(vertices: Uint32Array, selected: boolean): void {
    if (vertices.length === 0) return;
    let least = Infinity;
    let most = 0;
    for (const v of vertices) {
      this.selection[v] = selected ? 255 : 0;
      least = Math.min(least, v);
      most = Math.max(most, v);
    }
    this.selected = mergedIndices(this.selected, vertices);
    this.uploadSpan("selection", [least, most]);
    this.onChange();
  }

  /** Takes a message of kind `roles`: region, fixed part and handles. */
  setRoles(message: BinaryMessage): void {
    this.region = message.indices("region") ?? new Uint32Array();
    this.fixed = message.indices("fixed") ?? new Uint32Array();
    this.handles.clear();
    for (const [name, vertices] of message.handles()) this.handles.set(name, vertices);
    this.linear.discardWeights();
    this.deform.linear.value = false;
    this.slices.start("tint", this.paintRoles());
  }

  /** Yields geometries that draw nothing but bring one attribute each to the GPU, to relieve the first picture. */
  *uploadGeometries(): Generator<BufferGeometry, void> {
    const alone = (set: (geometry: BufferGeometry) => void) => {
      const geometry = new BufferGeometry();
      set(geometry);
      geometry.boundingSphere = this.geometry.boundingSphere;
      geometry.setDrawRange(0, 0);
      return geometry;
    };
    for (const attribute of Object.values(this.geometry.attributes))
      yield alone((geometry) => geometry.setAttribute("alone", attribute));
    yield alone((geometry) => geometry.setIndex(this.fine));
  }

  /** Colours vertices instead of their roles: 4 bytes each, as `writeTint` makes them. */
  setTint(tint: Uint8Array): void {
    this.tint.set(tint);
    this.uploadSpan("tint", [0, this.vertexCount - 1]);
    this.onChange();
  }

  dispose(): void {
    this.slices.stopAll();
    this.linear.discardWeights();
    this.textured?.dispose();
    for (const picture of this.pictures.values()) picture.dispose();
    for (const drawn of [this.mesh, this.wire, this.boundary]) {
      drawn?.geometry.dispose();
      (drawn?.material as ShaderMaterial | undefined)?.dispose();
    }
  }

  private measure(): void {
    const { min, max } = this.box;
    min.setScalar(Infinity);
    max.setScalar(-Infinity);
    const p = this.rest;
    for (let i = 0; i < p.length; i += 3) {
      const x = p[i] as number;
      const y = p[i + 1] as number;
      const z = p[i + 2] as number;
      if (x < min.x) min.x = x;
      if (x > max.x) max.x = x;
      if (y < min.y) min.y = y;
      if (y > max.y) max.y = y;
      if (z < min.z) min.z = z;
      if (z > max.z) max.z = z;
    }
    if (!(min.x <= max.x)) {
      min.setScalar(0);
      max.setScalar(0);
    }
    this.box.diagonal = min.distanceTo(max);
  }

  private makeGeometry(): void {
    const { geometry } = this;
    geometry.setIndex(this.fine);
    geometry.boundingSphere = this.sphere(); // so that three.js does not compute it
    geometry.setAttribute("tint", new BufferAttribute(this.tint, 4, true));
    geometry.setAttribute("selection", new BufferAttribute(this.selection, 1, true));
    if (this.uv !== undefined) geometry.setAttribute("uv", new BufferAttribute(this.uv, 2));
    if (this.colours !== undefined) geometry.setAttribute("colours", new BufferAttribute(this.colours, 3));
    this.useAttributes();
  }

  private readonly attributes = new Map<Float32Array, BufferAttribute>();
  private attributeOf(array: Float32Array): BufferAttribute {
    const known = this.attributes.get(array) ?? new BufferAttribute(array, 3);
    this.attributes.set(array, known);
    return known;
  }
  private useAttributes(): void {
    for (const geometry of [this.geometry, this.wire?.geometry, this.boundary?.geometry]) {
      geometry?.setAttribute("position", this.attributeOf(this.positions));
      geometry?.setAttribute("normal", this.attributeOf(this.normals));
    }
  }

  /** Adds the attribute `rest`, for shading and heat maps that use the rest shape. */
  needRest(): void {
    if (this.geometry.hasAttribute("rest")) return;
    this.geometry.setAttribute("rest", this.attributeOf(this.rest));
    this.mesh.material.defines["HAS_REST"] = 1;
    this.mesh.material.needsUpdate = true;
  }

  /** Shows the mesh with its textures, or with a checkerboard where there is none. */
  showTextures(textures: boolean): void {
    this.wantsTextures = textures;
    if (!textures || this.textured === undefined || this.textured.mesh !== undefined) return;
    if (!this.slices.isRunning("textures")) this.slices.start("textures", this.makeTextures(this.textured));
  }

  private *makeTextures(textured: TexturedSurface): Generator<void, void> {
    yield* textured.make();
    this.onChange();
  }

  private followTextures(): void {
    const drawn = this.textured?.mesh;
    if (drawn === undefined) return;
    drawn.visible = this.wantsTextures && !this.heat.isShown;
    this.mesh.visible = !drawn.visible;
    const asOf = `${this.version} ${this.painted} ${this.isBefore} ${this.linear.isReady}`;
    if (drawn.visible) this.textured?.follow(asOf);
  }

  /** Makes the textured surface; undefined for a mesh without texture coordinates for its corners. */
  private texturesOf(message: BinaryMessage, images: ReadonlyMap<number, Picture>): TexturedSurface | undefined {
    const pictures = message.indices("pictures");
    const uv = message.floats("corner_uv") ?? (pictures === undefined ? undefined : this.cornersUv());
    if (uv === undefined) return undefined;
    const makeMaterial = () => surfaceMaterial(this.look, this.deform, this.own);
    return new TexturedSurface(this, uv, pictures, images, makeMaterial);
  }

  /** Returns the vertices' texture coordinates, one pair for each corner. */
  private cornersUv(): Float32Array | undefined {
    const { uv, triangles } = this;
    if (uv === undefined) return undefined;
    return new Float32Array(2 * triangles.length).map((_, i) => uv[2 * (triangles[i >> 1] as number) + (i & 1)] as number);
  }

  /** Sets a coarse version of `triangles`, for pictures that must be fast. */
  setCoarse(triangles: Uint32Array): void {
    this.coarse = new BufferAttribute(triangles, 1);
  }
  showCoarse(coarse: boolean): void {
    this.followTextures();
    this.geometry.setIndex(coarse ? (this.coarse ?? this.fine) : this.fine);
    if (this.wire !== undefined) this.wire.visible = this.wantsWire && !(coarse && this.coarse !== undefined);
  }

  /** Takes all edges and the boundary edges, each edge once: two vertices each. */
  setEdges(edges: Uint32Array, boundary: Uint32Array): void {
    this.edges = edges;
    if (boundary.length > 0) {
      this.boundary = surfaceLines(this.geometry, boundary, this.deform, this.look.boundaryColour, 0.95);
      this.boundary.renderOrder = 3;
      this.object.add(this.boundary);
    }
    this.showWire(this.wantsWire);
    this.heat.setEdges(edges);
    this.onChange();
  }
  showWire(wire: boolean): void {
    this.wantsWire = wire;
    if (wire && this.wire === undefined && this.edges !== undefined) {
      this.wire = surfaceLines(this.geometry, this.edges, this.deform, this.look.wireColour, 0.32);
      this.object.add(this.wire);
    }
    if (this.wire !== undefined) this.wire.visible = wire;
  }

  private *paintRoles(): Generator<void, void> {
    const { tint } = this;
    tint.fill(0);
    const depth = this.region.length === 0 ? undefined : yield* depthInRegion(this.rest, this.triangles, this.region);
    for (const v of this.fixed) writeTint(tint, v, fixedColour, 0.25);
    const isFixed = new Set(this.fixed);
    this.region.forEach((v, i) => {
      const inside = depth?.[i] ?? 1;
      if (isFixed.has(v)) writeTint(tint, v, fixedColour, fixedStrength(inside));
      else writeTint(tint, v, regionColour, regionStrength(inside));
    });
    let order = 0;
    for (const vertices of this.handles.values()) {
      for (const v of vertices) writeTint(tint, v, handleColour(order), 0.85);
      ++order;
    }
    this.uploadSpan("tint", [0, this.vertexCount - 1]);
    this.onChange();
  }

  private takeChanged(positions: Uint32Array | undefined, normals: Uint32Array | undefined): void {
    this.upload(this.streamed.positions, positions);
    this.upload(this.streamed.normals, normals);
    if (positions === undefined) this.useAttributes();
  }

  private upload(array: Float32Array, vertices: Uint32Array | undefined): void {
    const attribute = this.attributeOf(array);
    if (vertices === undefined) attribute.addUpdateRange(0, array.length);
    else for (const [first, last] of runsOf(vertices)) attribute.addUpdateRange(3 * first, 3 * (last - first + 1));
    attribute.needsUpdate = true;
  }

  private uploadSpan(name: "selection" | "tint", span: readonly [number, number] | undefined): void {
    if (span === undefined || span[1] < span[0]) return;
    ++this.painted;
    const attribute = this.geometry.getAttribute(name) as BufferAttribute;
    attribute.addUpdateRange(attribute.itemSize * span[0], attribute.itemSize * (span[1] - span[0] + 1));
    attribute.needsUpdate = true;
  }
}
