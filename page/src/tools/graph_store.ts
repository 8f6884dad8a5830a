import { signal } from "@preact/signals";
import { Slices } from "../view/surface/slices";
import type { Surface } from "../view/surface/surface";
import { MeshGraph } from "./mesh_graph";

/** The graphs of surfaces, made in the background. */
export class GraphStore {
  /** Counts finished graphs, for code that waits for one. */
  readonly made = signal(0);
  private readonly graphs = new WeakMap<Surface, MeshGraph>();
  private readonly begun = new WeakSet<Surface>();
  private readonly slices = new Slices(8);

  /** Returns the graph of a surface at rest; undefined while it is being made. */
  of(surface: Surface): MeshGraph | undefined {
    if (!this.begun.has(surface)) {
      this.begun.add(surface);
      this.slices.start(`graph ${surface.id}`, this.make(surface));
    }
    return this.graphs.get(surface);
  }

  private *make(surface: Surface): Generator<void, void> {
    const graph = yield* MeshGraph.make({ positions: surface.rest, triangles: surface.triangles });
    this.graphs.set(surface, graph);
    ++this.made.value;
  }
}
