import { Matrix4, Vector3, type IUniform, type Texture } from "three";

/**
 * GLSL functions for the shown position of a vertex, shared by all materials that draw a surface. Without `linear` the
 * position is the attribute's. With `linear` the handles' maps move it by the formulas of `HandleBuffers`
 * (include/meshgraft/deform/quick_frames.h).
 */
export const deformShader = /* glsl */ `
in int weightRow;  // 1 + its row in the weights; 0: it stays
uniform highp sampler2D weights, basePositions, baseNormals, baseMaps, frames;
uniform bool linear, hasMaps, hasTurns;
uniform int handleCount;
uniform vec3 weightsCentre;  // less the surface's offset
uniform float weightsScale;

vec4 texelAt(highp sampler2D source, int i) {
  int width = textureSize(source, 0).x;
  return texelFetch(source, ivec2(i % width, i / width), 0);
}

void moveByHandles(inout vec3 point, inout vec3 direction) {
  int row = weightRow - 1;
  vec3 moved = vec3(0.0), m0 = vec3(1, 0, 0), m1 = vec3(0, 1, 0), m2 = vec3(0, 0, 1);
  for (int h = 0; h < handleCount; ++h) {
    mat3x4 f = mat3x4(texelAt(frames, 3 * h), texelAt(frames, 3 * h + 1), texelAt(frames, 3 * h + 2));
    int k = (hasTurns ? 4 : 1) * (row * handleCount + h);
    moved += texelAt(weights, k) * f;
    if (!hasTurns) continue;
    m0 += texelAt(weights, k + 1) * f;
    m1 += texelAt(weights, k + 2) * f;
    m2 += texelAt(weights, k + 3) * f;
  }
  point = weightsCentre + weightsScale * (texelAt(basePositions, row).xyz + moved);
  if (!hasTurns) return;
  if (hasMaps) {
    m0 += texelAt(baseMaps, 3 * row).xyz;
    m1 += texelAt(baseMaps, 3 * row + 1).xyz;
    m2 += texelAt(baseMaps, 3 * row + 2).xyz;
  }
  vec3 n = texelAt(baseNormals, row).xyz;
  vec3 turned = n.x * cross(m1, m2) + n.y * cross(m2, m0) + n.z * cross(m0, m1);
  float size = length(turned);
  if (size > 0.0) direction = turned / size;
}

void deformVertex(out vec3 point, out vec3 direction) {
  point = position;
  direction = normal;
  if (linear && weightRow > 0) moveByHandles(point, direction);
}
`;

/** The uniforms of `deformShader`, shared by the materials of one surface. */
export interface DeformUniforms {
  [name: string]: IUniform;
  weights: IUniform<Texture | null>;
  basePositions: IUniform<Texture | null>;
  baseNormals: IUniform<Texture | null>;
  baseMaps: IUniform<Texture | null>;
  frames: IUniform<Texture | null>;
  linear: IUniform<boolean>;
  hasMaps: IUniform<boolean>;
  hasTurns: IUniform<boolean>;
  handleCount: IUniform<number>;
  weightsCentre: IUniform<Vector3>;
  weightsScale: IUniform<number>;
}

export function deformUniforms(): DeformUniforms {
  return {
    weights: { value: null },
    basePositions: { value: null },
    baseNormals: { value: null },
    baseMaps: { value: null },
    frames: { value: null },
    linear: { value: false },
    hasMaps: { value: false },
    hasTurns: { value: false },
    handleCount: { value: 0 },
    weightsCentre: { value: new Vector3() },
    weightsScale: { value: 1 },
  };
}

/**
 * Writes a handle's pose (x' = L x + t, coordinates of the model) like `pose_matrix` in src/deform/solve/pose_matrix.h, in
 * the units of weights with this centre and scale. Rows 0 to 2 are (L − I)ᵀ, row 3 is (centre (L − I)ᵀ + tᵀ) / scale.
 * The output is column-major, as the shader reads it: 3 times 4 numbers.
 */
export function writeFrame(pose: Matrix4, centre: readonly number[], scale: number, out: Float32Array, at = 0): void {
  const e = pose.elements; // column-major: L(i, j) = e[i + 4 j]
  for (let i = 0; i < 3; ++i) {
    let shift = e[12 + i] ?? 0;
    for (let j = 0; j < 3; ++j) {
      const change = (e[i + 4 * j] ?? 0) - (i === j ? 1 : 0);
      out[at + 4 * i + j] = change;
      shift += change * (centre[j] ?? 0);
    }
    out[at + 4 * i + 3] = shift / scale;
  }
}
