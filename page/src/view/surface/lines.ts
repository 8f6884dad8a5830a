import { BufferAttribute, BufferGeometry, Color, GLSL3, LineSegments, ShaderMaterial, type IUniform } from "three";
import { deformShader, type DeformUniforms } from "./deform_shader";

const vertexShader = /* glsl */ `
${deformShader}
void main() {
  vec3 point, direction;
  deformVertex(point, direction);
  vec4 seen = modelViewMatrix * vec4(point, 1.0);
  bool isParallel = projectionMatrix[3][3] == 1.0;
  // Draws lines a little nearer to the camera than the surface, at the same pixels.
  if (!isParallel) seen.xyz *= 0.998;
  gl_Position = projectionMatrix * seen;
  if (isParallel) gl_Position.z -= 2e-4 * gl_Position.w;
}
`;
const fragmentShader = /* glsl */ `
uniform vec3 lineColour;
uniform float strength;
out vec4 colour;
void main() { colour = vec4(lineColour, strength); }
`;

/** Makes line segments for edges of a surface (two vertices each), which are drawn over it and deform with it. */
export function surfaceLines(
  surface: BufferGeometry,
  edges: Uint32Array,
  deform: DeformUniforms,
  colour: IUniform<Color>,
  strength: number,
): LineSegments<BufferGeometry, ShaderMaterial> {
  const geometry = new BufferGeometry();
  for (const name of ["position", "normal", "weightRow"]) geometry.setAttribute(name, surface.getAttribute(name));
  geometry.setIndex(new BufferAttribute(edges, 1));
  geometry.boundingSphere = surface.boundingSphere;
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms: { ...deform, lineColour: colour, strength: { value: strength } },
    transparent: true,
    depthWrite: false,
  });
  const lines = new LineSegments(geometry, material);
  lines.frustumCulled = false;
  lines.renderOrder = 2;
  return lines;
}
