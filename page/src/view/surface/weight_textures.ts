import { ExternalTexture, type WebGLRenderer } from "three";

const mostBytes = 768 * 1024 * 1024; // limit for one array of weights on the GPU
const sliceBytes = 4 * 1024 * 1024;

/** Returns the size of a texture for this many texels, at most 4096 wide; undefined if it does not fit. */
export function textureSize(texels: number, largest: number): { width: number; height: number } | undefined {
  const width = Math.min(4096, largest);
  const height = Math.max(1, Math.ceil(texels / width));
  return height <= largest && 16 * texels <= mostBytes ? { width, height } : undefined;
}

/**
 * Uploads an array to a texture, with `components` numbers (3 or 4) a texel. Texel i is at (i mod width, i div width).
 * Yields between slices. Undefined if it does not fit.
 */
export function* uploadArray(
  renderer: WebGLRenderer,
  values: Float32Array,
  components: 3 | 4,
): Generator<void, ExternalTexture | undefined> {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const texels = values.length / components;
  const size = textureSize(texels, renderer.capabilities.maxTextureSize);
  if (size === undefined) return undefined;
  const { width, height } = size;
  const texture = gl.createTexture();
  const bind = () => {
    renderer.state.bindTexture(gl.TEXTURE_2D, texture, gl.TEXTURE0);
    plainUnpacking(renderer, gl);
  };
  bind();
  gl.texStorage2D(gl.TEXTURE_2D, 1, components === 4 ? gl.RGBA32F : gl.RGB32F, width, height);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
  const format = components === 4 ? gl.RGBA : gl.RGB;
  const rows = Math.max(1, Math.floor(sliceBytes / (4 * components * width)));
  for (let y = 0; y < height;) {
    bind();
    const whole = Math.min(rows, Math.floor(texels / width) - y);
    const [w, h] = whole > 0 ? [width, whole] : [texels - y * width, 1];
    if (w > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, y, w, h, format, gl.FLOAT, values, components * y * width);
    renderer.state.unbindTexture();
    y += h;
    yield;
  }
  return new ExternalTexture(texture);
}

function plainUnpacking(renderer: WebGLRenderer, gl: WebGL2RenderingContext): void {
  const { state } = renderer;
  state.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  state.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  state.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  state.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
}
