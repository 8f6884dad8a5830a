import { BufferAttribute, BufferGeometry, Mesh } from "three";
import type { ShaderMaterial } from "three";
import type { Picture } from "./picture";
import type { Surface } from "./surface";
import { wedgesOf, type Wedges } from "./wedges";

/** The attributes of a surface that are copied to its wedges, with their numbers per vertex. */
const followed = [
  ["position", 3],
  ["normal", 3],
  ["tint", 4],
  ["selection", 1],
] as const;

/**
 * A surface with its textures. It is drawn by wedges, because a vertex on a texture seam has several texture
 * coordinates. It copies what the surface shows whenever that changes.
 */
export class TexturedSurface {
  mesh: Mesh<BufferGeometry, ShaderMaterial[]> | undefined;
  private wedges: Wedges | undefined;
  private shownAsOf = "";
  private isDisposed = false;

  /** `uv`: per corner, 2 numbers each; `pictures`: per triangle, 0 for none; `images`: by number. The caller disposes of them. */
  constructor(
    private readonly surface: Surface,
    private readonly uv: Float32Array,
    private readonly pictures: Uint32Array | undefined,
    private readonly images: ReadonlyMap<number, Picture>,
    private readonly makeMaterial: () => ShaderMaterial,
  ) {}

  /** Makes the wedges, and starts to load the images. */
  *make(): Generator<void, void> {
    const { surface } = this;
    const wedges = yield* wedgesOf(surface.triangles, surface.vertexCount, this.uv, this.pictures);
    const geometry = new BufferGeometry();
    const count = wedges.vertices.length;
    for (const [name, size] of followed) {
      const array = size === 3 ? new Float32Array(3 * count) : new Uint8Array(size * count);
      geometry.setAttribute(name, new BufferAttribute(array, size, size !== 3));
    }
    geometry.setAttribute("uv", new BufferAttribute(wedges.uv, 2));
    geometry.setAttribute("weightRow", surface.linear.weightRowsOf(wedges.vertices));
    geometry.setIndex(new BufferAttribute(wedges.triangles, 1));
    geometry.boundingSphere = surface.geometry.boundingSphere;
    wedges.groups.forEach(({ start, count }, i) => geometry.addGroup(start, count, i));
    const materials = wedges.groups.map(({ picture }) => this.materialOf(this.images.get(picture)));
    this.mesh = new Mesh(geometry, materials);
    this.mesh.frustumCulled = false;
    this.wedges = wedges;
    surface.object.add(this.mesh);
  }

  /** Copies the surface's shown attributes if `asOf`, which identifies its state, has changed. */
  follow(asOf: string): void {
    const { mesh, wedges, surface } = this;
    if (mesh === undefined || wedges === undefined || asOf === this.shownAsOf) return;
    this.shownAsOf = asOf;
    for (const [name, size] of followed) {
      const from = surface.geometry.getAttribute(name).array;
      const attribute = mesh.geometry.getAttribute(name) as BufferAttribute;
      const to = attribute.array;
      for (let w = 0; w < wedges.vertices.length; ++w)
        for (let k = 0; k < size; ++k) to[size * w + k] = from[size * (wedges.vertices[w] as number) + k] as number;
      attribute.needsUpdate = true;
    }
    mesh.geometry.setAttribute("weightRow", surface.linear.weightRowsOf(wedges.vertices));
  }

  dispose(): void {
    this.isDisposed = true;
    this.mesh?.geometry.dispose();
    for (const material of this.mesh?.material ?? []) material.dispose();
  }

  private materialOf(picture: Picture | undefined): ShaderMaterial {
    const material = this.makeMaterial();
    material.defines["HAS_UV"] = 1;
    Object.assign(material.uniforms, { picture: { value: null }, hasPicture: { value: false } });
    if (picture !== undefined) {
      this.show(picture, material);
      if (picture.texture === undefined) void picture.load().then(() => this.show(picture, material));
    }
    return material;
  }

  /** Shows an image. If the browser cannot read it, the surface keeps its checkerboard. */
  private show(picture: Picture, material: ShaderMaterial): void {
    if (picture.texture === undefined || this.isDisposed) return;
    Object.assign(material.uniforms["picture"] ?? {}, { value: picture.texture });
    Object.assign(material.uniforms["hasPicture"] ?? {}, { value: true });
    this.surface.onChange();
  }
}
