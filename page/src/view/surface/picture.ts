import { LinearMipmapLinearFilter, NoColorSpace, RepeatWrapping, Texture } from "three";

/** A texture image. It is read when it is first shown. */
export class Picture {
  /** Undefined until it is loaded, and if the browser cannot read it. */
  texture: Texture | undefined;
  private loading: Promise<void> | undefined;
  private isDisposed = false;

  constructor(private readonly file: Uint8Array<ArrayBuffer>) {}

  load(): Promise<void> {
    this.loading ??= this.read();
    return this.loading;
  }

  dispose(): void {
    this.isDisposed = true;
    this.texture?.dispose();
  }

  private async read(): Promise<void> {
    const image = await createImageBitmap(new Blob([this.file]), {
      imageOrientation: "flipY",
      premultiplyAlpha: "none",
      colorSpaceConversion: "none",
    }).catch(() => undefined);
    if (image === undefined || this.isDisposed) return;
    const texture = new Texture(image, undefined, RepeatWrapping, RepeatWrapping);
    texture.flipY = false; // the bitmap is flipped already
    texture.colorSpace = NoColorSpace;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.anisotropy = 8;
    texture.needsUpdate = true;
    this.texture = texture;
  }
}
