/** What a worker is asked about one mesh, and what it answers. Arrays are its own from then on. */
export type ToWorker =
  | { what: "begin"; positions: Float32Array; triangles: Uint32Array; version: number; coarse: number }
  | { what: "refit"; positions: Float32Array; version: number };

export type FromWorker =
  | { what: "coarse"; triangles: Uint32Array }
  | { what: "tree"; version: number; roots: ArrayBuffer[]; order: Uint32Array | Uint16Array | null }
  | { what: "edges"; edges: Uint32Array; boundary: Uint32Array };

/** A worker for one mesh. `coarse`: about how many triangles its coarse version has; 0: none is made. */
export class MeshWork {
  private readonly worker = new Worker(new URL("./mesh_worker.ts", import.meta.url), { type: "module" });

  constructor(
    positions: Float32Array,
    triangles: Uint32Array,
    version: number,
    coarse: number,
    hear: (answer: FromWorker) => void,
  ) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => hear(data);
    const copies = { positions: positions.slice(), triangles: triangles.slice() };
    this.send({ what: "begin", version, coarse, ...copies }, [copies.positions.buffer, copies.triangles.buffer]);
  }

  refit(positions: Float32Array, version: number): void {
    const copy = positions.slice();
    this.send({ what: "refit", positions: copy, version }, [copy.buffer]);
  }

  dispose(): void {
    this.worker.terminate();
  }

  private send(message: ToWorker, transfer: Transferable[]): void {
    this.worker.postMessage(message, transfer);
  }
}
