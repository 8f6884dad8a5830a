/**
 * Messages to a worker for one mesh, and its answers. Arrays are sent in slices, so that no copy blocks the page for
 * long.
 */
export type ToWorker =
  | { what: "part"; of: "positions" | "triangles"; at: number; length: number; values: Float32Array | Uint32Array }
  | { what: "begin"; version: number; coarse: number }
  | { what: "refit"; version: number };

export type FromWorker =
  | { what: "coarse"; triangles: Uint32Array }
  | { what: "tree"; version: number; roots: ArrayBuffer[]; order: Uint32Array | Uint16Array | null }
  | { what: "edges"; edges: Uint32Array; boundary: Uint32Array };

const partLength = 1 << 20; // numbers

/** A worker for one mesh. `coarse`: approximate number of triangles of the coarse version; 0: none is made. */
export class MeshWork {
  private worker: Worker | undefined;
  private isDisposed = false;

  constructor(private readonly onAnswer: (answer: FromWorker) => void) {}

  /** Sends the mesh and starts the worker. Yields between slices. */
  *begin(positions: Float32Array, triangles: Uint32Array, version: number, coarse: number): Generator<void, void> {
    this.worker = new Worker(new URL("./mesh_worker.ts", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.onAnswer(data);
    yield;
    yield* this.sendParts("positions", positions);
    yield* this.sendParts("triangles", triangles);
    this.send({ what: "begin", version, coarse });
  }

  /** Sends new positions. Yields between slices. `version` is called after the last slice. */
  *refit(positions: Float32Array, version: () => number): Generator<void, void> {
    yield* this.sendParts("positions", positions);
    this.send({ what: "refit", version: version() });
  }

  dispose(): void {
    this.isDisposed = true;
    this.worker?.terminate();
  }

  private *sendParts(of: "positions" | "triangles", values: Float32Array | Uint32Array): Generator<void, void> {
    for (let at = 0; at < values.length && !this.isDisposed; at += partLength) {
      const part = values.slice(at, at + partLength);
      this.send({ what: "part", of, at, length: values.length, values: part }, [part.buffer]);
      yield;
    }
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void {
    if (!this.isDisposed) this.worker?.postMessage(message, transfer);
  }
}
