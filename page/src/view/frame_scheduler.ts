import type { WebGLRenderer } from "three";
import type { Detail } from "./pipeline";

const slowMs = 50; // a picture that takes longer is made with less detail while something moves
const smoothMs = 6 * slowMs; // a picture with smooth edges may take this long at rest
const refinedMs = 600; // a picture with rough edges that took no longer is drawn once more with smooth ones,
const idleMs = 400; // when nothing was asked for since

/** Times of performance.now(): when a picture was begun, all drawing of it was called for, and the GPU was done. */
export interface Drawn {
  begin: number;
  drawn: number;
  end: number;
}

/**
 * When pictures are made, and how finely: the next one when the last one is done, so that none wait in a row; less detail
 * while something moves, where full detail takes long.
 */
export class FrameScheduler {
  /** Of the last pictures at rest and in motion, from the call to the GPU's end. */
  restMs = 0;
  movingMs = 0;
  private wanted = false;
  private busy = false;
  private smooth = true; // whether edges are drawn smoothly at rest
  private refining = false; // whether the next picture, or the one on its way, is the last one with smooth edges
  private refineTimer: ReturnType<typeof setTimeout> | undefined;
  private readonly recent: number[] = [];

  constructor(
    private readonly draw: () => void,
    private readonly done: (picture: Drawn, medianMs: number) => void,
  ) {}

  request(): void {
    clearTimeout(this.refineTimer);
    if (!this.busy) this.refining = false;
    if (this.wanted) return;
    this.wanted = true;
    if (!this.busy) requestAnimationFrame(() => this.begin());
  }

  /** Something large comes: how long it takes, a picture with rough edges shall tell. */
  expectMuch(): void {
    this.smooth = false;
  }

  /** What full detail is, for a GPU as quick as this one. */
  detail(moving: boolean, mayReduce: boolean, occlusion: boolean): Detail {
    const full = { scale: 1, samples: this.smooth || this.refining ? 4 : 0, occlusion };
    if (!moving || !mayReduce || this.restMs <= slowMs) return full;
    return { scale: this.movingMs > slowMs ? 0.5 : 0.75, samples: 0, occlusion: false };
  }
  /** Whether a coarse version of a large mesh is shown in its place. */
  wantsCoarse(moving: boolean, mayReduce: boolean): boolean {
    return moving && mayReduce && this.restMs > slowMs;
  }

  /** Tells when the GPU is done with what was drawn since `start`. */
  finish(renderer: WebGLRenderer, start: number, moving: boolean): void {
    this.busy = true;
    const drawn = performance.now();
    void cardIsIdle(renderer).then(() => this.end({ begin: start, drawn, end: performance.now() }, moving));
  }

  private begin(): void {
    if (this.busy || !this.wanted) return; // asked for while one was drawn: `end` takes it up
    this.wanted = false;
    this.draw();
  }

  private end(picture: Drawn, moving: boolean): void {
    this.busy = false;
    const ms = picture.end - picture.begin;
    if (moving) this.movingMs = this.movingMs === 0 ? ms : 0.7 * this.movingMs + 0.3 * ms;
    else if (!this.refining) this.takeRest(ms);
    this.refining = false;
    this.recent.push(ms);
    if (this.recent.length > 31) this.recent.shift();
    const sorted = [...this.recent].sort((a, b) => a - b);
    this.done(picture, sorted[sorted.length >> 1] ?? 0);
    if (this.wanted) requestAnimationFrame(() => this.begin());
  }

  private takeRest(ms: number): void {
    this.restMs = ms;
    if (!this.smooth && ms < refinedMs) this.refineTimer = setTimeout(() => this.refine(), idleMs);
    this.smooth = ms < (this.smooth ? smoothMs : smoothMs / 4);
  }

  private refine(): void {
    this.request();
    this.refining = true;
  }
}

/** Resolves once the GPU has done all that it was told to; until then, telling it more may stop the page. */
export function cardIsIdle(renderer: WebGLRenderer): Promise<void> {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  return new Promise((resolve) => {
    const look = () => {
      const isBusy = fence !== null && gl.clientWaitSync(fence, 0, 0) === gl.TIMEOUT_EXPIRED;
      if (isBusy && !gl.isContextLost()) return void setTimeout(look, 3);
      if (fence !== null) gl.deleteSync(fence);
      resolve();
    };
    setTimeout(look, 1);
  });
}
