import { BufferAttribute, BufferGeometry, LinearMipmapLinearFilter, Mesh, NoColorSpace, RepeatWrapping, Texture } from "three";
import type { ShaderMaterial } from "three";
import type { Surface } from "./surface";
import { wedgesOf, type Wedges } from "./wedges";

/** What of a surface is copied to its wedges, and how many numbers a vertex has. */
const followed = [
  ["position", 3],
  ["normal", 3],
  ["tint", 4],
  ["selection", 1],
] as const;

/**
 * A surface with its pictures: drawn by wedges, since a vertex has several places in a picture where that is cut. It
 * copies what the surface shows whenever that changes.
 */
export class TexturedSurface {
  mesh: Mesh<BufferGeometry, ShaderMaterial[]> | undefined;
  private wedges: Wedges | undefined;
  private shownAsOf = "";
  private isDisposed = false;

  /** `uv`: of corners, 2 numbers each; `pictures`: of triangles, 0 for none; `files`: pictures from number 1 on. */
  constructor(
    private readonly surface: Surface,
    private readonly uv: Float32Array,
    private readonly pictures: Uint32Array | undefined,
    private readonly files: readonly Uint8Array<ArrayBuffer>[],
    private readonly makeMaterial: () => ShaderMaterial,
  ) {}

  /** Finds the wedges, and calls for the pictures. */
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
    geometry.setAttribute("mover", surface.linear.moversOf(wedges.vertices));
    geometry.setIndex(new BufferAttribute(wedges.triangles, 1));
    geometry.boundingSphere = surface.geometry.boundingSphere;
    wedges.groups.forEach(({ start, count }, i) => geometry.addGroup(start, count, i));
    const materials = wedges.groups.map(({ picture }) => this.materialOf(this.files[picture - 1]));
    this.mesh = new Mesh(geometry, materials);
    this.mesh.frustumCulled = false;
    this.wedges = wedges;
    surface.object.add(this.mesh);
  }

  /** Brings what is drawn to what the surface shows. */
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
    mesh.geometry.setAttribute("mover", surface.linear.moversOf(wedges.vertices));
  }

  dispose(): void {
    this.isDisposed = true;
    this.mesh?.geometry.dispose();
    for (const material of this.mesh?.material ?? []) {
      (material.uniforms["picture"]?.value as Texture | null)?.dispose();
      material.dispose();
    }
  }

  private materialOf(file: Uint8Array<ArrayBuffer> | undefined): ShaderMaterial {
    const material = this.makeMaterial();
    material.defines["HAS_UV"] = 1;
    Object.assign(material.uniforms, { picture: { value: null }, hasPicture: { value: false } });
    if (file !== undefined) void this.load(file, material);
    return material;
  }

  /** A picture that the browser cannot read is none: the surface keeps its checks. */
  private async load(file: Uint8Array<ArrayBuffer>, material: ShaderMaterial): Promise<void> {
    const image = await createImageBitmap(new Blob([file]), {
      imageOrientation: "flipY",
      premultiplyAlpha: "none",
      colorSpaceConversion: "none",
    }).catch(() => undefined);
    if (image === undefined || this.isDisposed) return;
    const texture = new Texture(image, undefined, RepeatWrapping, RepeatWrapping);
    texture.flipY = false; // it is already
    texture.colorSpace = NoColorSpace;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.anisotropy = 8;
    texture.needsUpdate = true;
    Object.assign(material.uniforms["picture"] ?? {}, { value: texture });
    Object.assign(material.uniforms["hasPicture"] ?? {}, { value: true });
    this.surface.onChange();
  }
}
