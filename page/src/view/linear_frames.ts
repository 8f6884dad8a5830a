import { DataTexture, FloatType, Matrix4, NearestFilter, RGBAFormat } from "three";
import type { BinaryFrame } from "../engine/binary_frame";
import { writeFrame, type DeformUniforms } from "./deform_shader";

/**
 * The handles' maps that the vertex shader moves a surface by, and when: from `show` on, until the engine's own
 * positions of the same poses are there.
 */
export class LinearFrames {
  isShown = false;
  private names: string[] = [];
  private centre: readonly [number, number, number] = [0, 0, 0];
  private scale = 1;
  private frames: DataTexture | undefined;
  private hasWeights = false;
  /** Where the document has the handles; `show` moves those that it is told of. */
  committed: ReadonlyMap<string, Matrix4> = new Map();
  /** Requests whose poses' numbers are not known yet, and the newest number. */
  private unanswered = 0;
  private newest = 0;

  constructor(
    readonly uniforms: DeformUniforms,
    readonly offset: readonly [number, number, number],
  ) {}

  /** Kind `weights`, of handles in this order. */
  setWeights(frame: BinaryFrame, names: Iterable<string>): void {
    this.names = [...names];
    this.centre = frame.header.offset ?? [0, 0, 0];
    this.scale = frame.header.scale ?? 1;
    const data = new Float32Array(12 * Math.max(1, this.names.length));
    this.frames = new DataTexture(data, 3 * Math.max(1, this.names.length), 1, RGBAFormat, FloatType, undefined, undefined, undefined, NearestFilter, NearestFilter);
    this.uniforms.frames.value = this.frames;
    this.hasWeights = false;
  }

  show(poses: ReadonlyMap<string, Matrix4>): boolean {
    if (!this.hasWeights || this.frames === undefined) return false;
    const data = this.frames.image.data as Float32Array;
    this.names.forEach((name, h) => {
      const pose = poses.get(name) ?? this.committed.get(name) ?? new Matrix4();
      writeFrame(pose, this.centre, this.scale, data, 12 * h);
    });
    this.frames.needsUpdate = true;
    this.isShown = true;
    return true;
  }

  /** A request with poses is on its way; its answer tells the number of their frames. */
  asked(): (pose: number) => void {
    ++this.unanswered;
    return (pose) => {
      --this.unanswered;
      this.newest = Math.max(this.newest, pose);
    };
  }

  /** Whether a frame of the engine takes the place of what the shader shows. */
  giveWayTo(pose: number, quality: string | undefined): boolean {
    if (!this.isShown) return false;
    if (this.unanswered > 0 || pose < this.newest || (quality !== undefined && quality !== "exact")) return false;
    this.isShown = false;
    return true;
  }

  /** Other handles, or none: the weights are of no use. */
  forget(): void {
    this.isShown = false;
    this.hasWeights = false;
  }

  dispose(): void {
    this.frames?.dispose();
  }
}
