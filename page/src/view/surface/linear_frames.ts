import { DataTexture, FloatType, Int32BufferAttribute, IntType, Matrix4, NearestFilter, RGBAFormat } from "three";
import type { BufferGeometry, ExternalTexture, WebGLRenderer } from "three";
import type { BinaryMessage } from "../../engine/binary_message";
import { writeFrame, type DeformUniforms } from "./deform_shader";
import { uploadArray } from "./weight_textures";

/**
 * The handles' maps by which the vertex shader moves a surface. They apply from `show` until the engine's own positions
 * for the same poses have arrived.
 */
export class LinearFrames {
  isShown = false;
  /** Whether the shader has weights. */
  isReady = false;
  /** The handles' maps in the document. They apply to handles that `show` is not given. */
  committed: ReadonlyMap<string, Matrix4> = new Map();
  /** Per vertex: 1 + its row in the weights, or 0 for a vertex that stays. */
  private readonly weightRows: Int32BufferAttribute;
  private names: string[] = [];
  private centre: readonly [number, number, number] = [0, 0, 0];
  private scale = 1;
  private frames: DataTexture | undefined;
  private textures: ExternalTexture[] = [];
  private renderer: WebGLRenderer | undefined;
  /** Number of requests whose frame number is not known yet, and the largest known frame number. */
  private unanswered = 0;
  private newest = 0;
  private exact = 0; // number of the newest exact frame

  constructor(
    private readonly uniforms: DeformUniforms,
    geometry: BufferGeometry,
    vertexCount: number,
    private readonly offset: readonly [number, number, number],
    private readonly onHide: () => void,
  ) {
    this.weightRows = new Int32BufferAttribute(vertexCount, 1);
    this.weightRows.gpuType = IntType;
    geometry.setAttribute("weightRow", this.weightRows);
  }

  /**
   * Takes a message of kind `weights`, with handles in this order, to the GPU. Yields in between. If the weights do not
   * fit, `isReady` stays false and only the engine's frames are shown.
   */
  *setWeights(message: BinaryMessage, names: Iterable<string>, renderer: WebGLRenderer): Generator<void, void> {
    this.discardWeights();
    this.renderer = renderer;
    this.names = [...names];
    const blocks = message.floats("blocks");
    const vertices = message.indices("vertices");
    const count = this.names.length;
    if (blocks === undefined || vertices === undefined || count === 0) return;
    const rows = (message.header.width ?? 0) / (4 * count);
    if (rows !== 1 && rows !== 4) return;
    const maps = message.floats("maps");
    const weights = yield* this.upload(blocks, 4);
    const basePositions = yield* this.upload(message.floats("positions"), 3);
    const baseNormals = rows === 4 ? yield* this.upload(message.floats("normals"), 3) : null;
    const baseMaps = maps?.length ? yield* this.upload(maps, 3) : null;
    if (weights === undefined || basePositions === undefined || baseNormals === undefined || baseMaps === undefined)
      return;
    Object.assign(this.uniforms.weights, { value: weights });
    Object.assign(this.uniforms.basePositions, { value: basePositions });
    Object.assign(this.uniforms.baseNormals, { value: baseNormals });
    Object.assign(this.uniforms.baseMaps, { value: baseMaps });
    this.uniforms.hasMaps.value = baseMaps !== null;
    this.uniforms.hasTurns.value = rows === 4;
    this.uniforms.handleCount.value = count;
    this.setUnits(message);
    this.numberRows(vertices, message.indices("rows"));
    this.makeFrames(count);
    this.isReady = true;
  }

  /**
   * Shows handles' maps, given by name. Other handles stay where the document has them. Returns whether the shader
   * shows them.
   */
  show(poses: ReadonlyMap<string, Matrix4>): boolean {
    if (!this.isReady || this.frames === undefined) return false;
    const data = this.frames.image.data as Float32Array;
    this.names.forEach((name, h) => {
      const pose = poses.get(name) ?? this.committed.get(name) ?? new Matrix4();
      writeFrame(pose, this.centre, this.scale, data, 12 * h);
    });
    this.frames.needsUpdate = true;
    this.isShown = true;
    return true;
  }

  /**
   * Notes that a request with poses was sent. The returned function must be called with the frame number in its answer.
   */
  beginRequest(): (pose: number) => void {
    ++this.unanswered;
    return (pose) => {
      --this.unanswered;
      this.newest = Math.max(this.newest, pose);
      this.hideWhenExact();
    };
  }

  /** Returns the `weightRow` attribute for copies of vertices, for a surface that draws copies. */
  weightRowsOf(vertices: Uint32Array): Int32BufferAttribute {
    const copies = new Int32BufferAttribute(new Int32Array(vertices.length), 1);
    vertices.forEach((v, i) => (copies.array[i] = this.weightRows.array[v] as number));
    copies.gpuType = IntType;
    return copies;
  }

  /** Returns whether a frame may replace what the shader shows. */
  mayReplace(pose: number, accuracy: string | undefined): boolean {
    return (accuracy === undefined || accuracy === "exact") && pose >= this.newest;
  }

  /** Notes that a frame of the engine has been shown. */
  noteStreamed(pose: number, accuracy: string | undefined): void {
    if (accuracy === undefined || accuracy === "exact") this.exact = Math.max(this.exact, pose);
    this.hideWhenExact();
  }

  /** Switches from the shader to the engine's positions once the exact frame of the newest poses is there. */
  private hideWhenExact(): void {
    if (this.unanswered > 0 || this.exact < this.newest || !this.isShown) return;
    this.isShown = false;
    this.onHide();
  }

  /** Discards the weights, because the handles have changed. */
  discardWeights(): void {
    this.isShown = false;
    this.isReady = false;
    for (const texture of this.textures) {
      this.renderer?.getContext().deleteTexture(texture.sourceTexture as WebGLTexture);
      texture.dispose();
    }
    this.textures = [];
    this.frames?.dispose();
    this.frames = undefined;
    for (const name of ["weights", "basePositions", "baseNormals", "baseMaps", "frames"])
      Object.assign(this.uniforms[name] ?? {}, { value: null });
  }

  private *upload(values: Float32Array | undefined, components: 3 | 4): Generator<void, ExternalTexture | undefined> {
    if (values === undefined || this.renderer === undefined) return undefined;
    const texture = yield* uploadArray(this.renderer, values, components);
    if (texture !== undefined) this.textures.push(texture);
    return texture;
  }

  private setUnits(message: BinaryMessage): void {
    this.centre = message.header.offset ?? [0, 0, 0];
    this.scale = message.header.scale ?? 1;
    const [x, y, z] = this.centre;
    this.uniforms.weightsCentre.value.set(x - this.offset[0], y - this.offset[1], z - this.offset[2]);
    this.uniforms.weightsScale.value = this.scale;
  }

  /** `rows`: for each of `vertices` its row in the weights; absent: its index in the list. */
  private numberRows(vertices: Uint32Array, rows: Uint32Array | undefined): void {
    const numbers = this.weightRows.array as Int32Array;
    numbers.fill(0);
    for (let i = 0; i < vertices.length; ++i)
      numbers[vertices[i] as number] = 1 + (rows === undefined ? i : (rows[i] as number));
    this.weightRows.needsUpdate = true;
  }

  private makeFrames(handles: number): void {
    const data = new Float32Array(12 * handles);
    this.frames = new DataTexture(data, 3 * handles, 1, RGBAFormat, FloatType);
    this.frames.minFilter = NearestFilter;
    this.frames.magFilter = NearestFilter;
    this.uniforms.frames.value = this.frames;
  }
}
