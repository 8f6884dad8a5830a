import type { WebGLRenderer } from "three";
import type { Detail } from "./pipeline";

const slowMs = 50; // a picture that takes longer is made with less detail while something moves
const smoothMs = 6 * slowMs; // an antialiased picture may take this long at rest
const refinedMs = 600; // a picture without antialiasing that took no longer is redrawn with it
const idleMs = 400; // time without a request before a picture is redrawn with antialiasing

/**
 * Times of performance.now(): when a picture was begun, when all its draw calls were issued, and when the GPU had
 * finished.
 */
export interface Drawn {
  begin: number;
  drawn: number;
  end: number;
}

/**
 * Decides when pictures are made, and in how much detail. A picture begins only when the last one is finished, so that
 * none queue up. If full detail is slow, less is used while something moves.
 */
export class FrameScheduler {
  /** Duration of the last picture at rest and of recent ones in motion, in ms until the GPU has finished. */
  restMs = 0;
  movingMs = 0;
  private wanted = false;
  private busy = false;
  private smooth = true; // whether edges are antialiased at rest
  private refining = false; // whether the next or current picture is the redrawn one with antialiasing
  private refineTimer: ReturnType<typeof setTimeout> | undefined;
  private readonly recent: number[] = [];

  constructor(
    private readonly draw: () => void,
    private readonly done: (picture: Drawn, medianMs: number) => void,
  ) {}

  /** Whether no picture is wanted or being made; an antialiased one may follow. */
  get isIdle(): boolean {
    return !this.wanted && !this.busy;
  }
  /** Whether no picture will be made until the next request. */
  get isFinished(): boolean {
    return this.isIdle && this.refineTimer === undefined;
  }

  request(): void {
    clearTimeout(this.refineTimer);
    this.refineTimer = undefined;
    if (!this.busy) this.refining = false;
    if (this.wanted) return;
    this.wanted = true;
    if (!this.busy) requestAnimationFrame(() => this.begin());
  }

  /**
   * Turns antialiasing off before a large surface appears. The duration of its first picture then decides whether
   * antialiasing returns.
   */
  expectLargeSurface(): void {
    this.smooth = false;
  }

  /** Returns the level of detail for the next picture, given the measured speed of the GPU. */
  detail(moving: boolean, mayReduce: boolean, occlusion: boolean): Detail {
    const full = { scale: 1, samples: this.smooth || this.refining ? 4 : 0, occlusion };
    if (!moving || !mayReduce || this.restMs <= slowMs) return full;
    return { scale: this.movingMs > slowMs ? 0.5 : 0.75, samples: 0, occlusion: false };
  }
  /** Returns whether large meshes are replaced by their coarse versions. */
  wantsCoarse(moving: boolean, mayReduce: boolean): boolean {
    return moving && mayReduce && this.restMs > slowMs;
  }

  /** Waits until the GPU has finished the picture begun at `start`, and records its duration. */
  finish(renderer: WebGLRenderer, start: number, moving: boolean): void {
    this.busy = true;
    const drawn = performance.now();
    void waitForGpu(renderer).then(() => this.end({ begin: start, drawn, end: performance.now() }, moving));
  }

  private begin(): void {
    if (this.busy || !this.wanted) return; // requested during a picture: `end` schedules it
    this.wanted = false;
    this.draw();
  }

  private end(picture: Drawn, moving: boolean): void {
    this.busy = false;
    const ms = picture.end - picture.begin;
    if (moving) this.movingMs = this.movingMs === 0 ? ms : 0.7 * this.movingMs + 0.3 * ms;
    else if (!this.refining) this.noteRest(ms);
    this.refining = false;
    this.recent.push(ms);
    if (this.recent.length > 31) this.recent.shift();
    const sorted = [...this.recent].sort((a, b) => a - b);
    this.done(picture, sorted[sorted.length >> 1] ?? 0);
    if (this.wanted) requestAnimationFrame(() => this.begin());
  }

  private noteRest(ms: number): void {
    this.restMs = ms;
    if (!this.smooth && ms < refinedMs) this.refineTimer = setTimeout(() => this.refine(), idleMs);
    this.smooth = ms < (this.smooth ? smoothMs : smoothMs / 4);
  }

  private refine(): void {
    this.refineTimer = undefined;
    this.request();
    this.refining = true;
  }
}

/** Resolves once the GPU has finished all its work. Further commands before that may block the page. */
export function waitForGpu(renderer: WebGLRenderer): Promise<void> {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  return new Promise((resolve) => {
    const poll = () => {
      const isBusy = fence !== null && gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED;
      if (isBusy && !gl.isContextLost()) return void setTimeout(poll, 3);
      if (fence !== null) gl.deleteSync(fence);
      resolve();
    };
    setTimeout(poll, 1);
  });
}
