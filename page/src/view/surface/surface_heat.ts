import { BufferAttribute, type BufferGeometry, type IUniform, type ShaderMaterial } from "three";
import type { HeatMap } from "../../app/view_settings";
import { bendsOf, detailOf, heatRange, heatTexture, legendOf, stretchOf, type Legend, type StretchOf } from "./heat";
import type { Slices } from "./slices";

/** The surface that is coloured. */
interface Coloured {
  readonly rest: Float32Array;
  readonly positions: Float32Array;
  readonly triangles: Uint32Array;
  /** Counts changes of `positions`. */
  readonly version: number;
  readonly geometry: BufferGeometry;
  readonly mesh: { readonly material: ShaderMaterial };
  readonly slices: Slices;
  onChange: () => void;
}

/** Another rest shape than the surface's own, and the triangles that it has. */
export interface Unstretched {
  readonly positions: Float32Array;
  readonly triangles: Uint32Array;
}

/** Colours a surface by per-vertex values, and updates them when the surface moves. */
export class SurfaceHeat {
  readonly uniforms: Record<"heatColours" | "heatRange" | "hasHeat", IUniform> = {
    heatColours: { value: null },
    heatRange: { value: [0, 1] },
    hasHeat: { value: false },
  };
  /** The meaning of the colours; null if there are none. */
  legend: Legend | null = null;
  private map: HeatMap = "none";
  private of: StretchOf = "area";
  private madeOf = -1; // version of the surface
  private edges: Uint32Array | undefined;
  private seam: Uint32Array = new Uint32Array();
  private unstretched: Unstretched | undefined;

  constructor(private readonly surface: Coloured) {}

  get isShown(): boolean {
    return this.uniforms.hasHeat.value === true;
  }

  show(map: HeatMap, of: StretchOf): void {
    if (map === this.map && of === this.of && (map === "none" || this.madeOf >= 0)) return;
    this.map = map;
    this.of = of;
    this.madeOf = -1;
    if (map !== "none") return this.renew();
    this.surface.slices.stop("heat");
    this.uniforms.hasHeat.value = false;
    this.legend = null;
    this.surface.onChange();
  }

  /** Recomputes the colours after the surface has moved. */
  renew(): void {
    const { slices } = this.surface;
    if (this.map !== "none" && !slices.isRunning("heat")) slices.start("heat", this.follow());
  }

  /** Sets the vertices of a seam, for the heat map `seam`. */
  setSeam(vertices: Uint32Array): void {
    this.seam = vertices;
    this.renewFrom("seam");
  }
  /** Sets what the heat map `stretch` compares with, if it is not the surface at rest. */
  setUnstretched(unstretched: Unstretched): void {
    this.unstretched = unstretched;
    this.renewFrom("stretch");
  }
  /** Takes each edge once: two vertices. */
  setEdges(edges: Uint32Array): void {
    this.edges = edges;
    this.renewFrom("detail");
  }
  private renewFrom(map: HeatMap): void {
    if (this.map !== map) return;
    this.madeOf = -1;
    this.renew();
  }

  private *follow(): Generator<void, void> {
    while (this.madeOf !== this.surface.version) {
      const { version } = this.surface;
      const values = yield* this.values();
      this.madeOf = version;
      if (values === undefined) return;
      const range = heatRange(this.map, values);
      this.surface.geometry.setAttribute("heat", this.attributeOf(values));
      this.uniforms.heatRange.value = range;
      this.uniforms.heatColours.value = heatTexture(this.map);
      this.uniforms.hasHeat.value = true;
      this.legend = legendOf(this.map, this.of, range);
      this.surface.onChange();
    }
  }

  private attributeOf(values: Float32Array): BufferAttribute {
    const { geometry, mesh } = this.surface;
    const known = geometry.getAttribute("heat") as BufferAttribute | undefined;
    if (known === undefined) {
      mesh.material.defines["HAS_HEAT"] = 1;
      mesh.material.needsUpdate = true;
      return new BufferAttribute(values, 1);
    }
    (known.array as Float32Array).set(values);
    known.needsUpdate = true;
    return known;
  }

  private *values(): Generator<void, Float32Array | undefined> {
    const { rest, positions, triangles } = this.surface;
    const from = this.unstretched ?? { positions: rest, triangles };
    if (this.map === "stretch") return yield* stretchOf(this.of, from.positions, positions, from.triangles);
    if (this.map === "seam") return this.seam.length === 0 ? undefined : bendsOf(positions, triangles, this.seam);
    if (this.edges === undefined) return undefined; // the worker is still computing them
    return yield* detailOf(positions, this.edges);
  }
}
