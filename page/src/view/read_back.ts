import {
  BufferGeometry,
  FloatType,
  GLSL3,
  NearestFilter,
  OrthographicCamera,
  Points,
  RGBAFormat,
  Scene,
  ShaderMaterial,
  WebGLRenderTarget,
} from "three";
import type { WebGLRenderer } from "three";
import { deformShader } from "./surface/deform_shader";
import type { Surface } from "./surface/surface";

const width = 2048;

const vertexShader = /* glsl */ `
${deformShader}
uniform vec2 size;
flat out vec3 shownPosition;
void main() {
  vec3 direction;
  deformVertex(shownPosition, direction);
  vec2 pixel = vec2(gl_VertexID % int(size.x), gl_VertexID / int(size.x)) + 0.5;
  gl_Position = vec4(2.0 * pixel / size - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
`;
const fragmentShader = /* glsl */ `
flat in vec3 shownPosition;
out vec4 result;
void main() { result = vec4(shownPosition, 1.0); }
`;

/**
 * Reads from the GPU the positions that the vertex shader gives a surface's vertices (3 numbers each, relative to its
 * offset). Rejects if the GPU cannot render to floating-point textures (EXT_color_buffer_float).
 */
export async function readPositions(renderer: WebGLRenderer, surface: Surface): Promise<Float32Array> {
  if (!renderer.getContext().getExtension("EXT_color_buffer_float"))
    throw new Error("the GPU draws no floats");
  const height = Math.max(1, Math.ceil(surface.vertexCount / width));
  const target = new WebGLRenderTarget(width, height, {
    type: FloatType,
    format: RGBAFormat,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthBuffer: false,
  });
  const geometry = new BufferGeometry();
  for (const name of ["position", "normal", "weightRow"]) geometry.setAttribute(name, surface.geometry.getAttribute(name));
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    depthTest: false,
    uniforms: { ...surface.deform, size: { value: [width, height] } },
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  const scene = new Scene();
  scene.add(points);
  renderer.setRenderTarget(target);
  renderer.render(scene, new OrthographicCamera());
  renderer.setRenderTarget(null);
  const pixels = new Float32Array(4 * width * height);
  await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height, pixels);
  target.dispose();
  material.dispose();
  return Float32Array.from(
    { length: 3 * surface.vertexCount },
    (_, i) => pixels[4 * Math.floor(i / 3) + (i % 3)] as number,
  );
}
