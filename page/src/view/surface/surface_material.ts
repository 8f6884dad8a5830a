import { Color, DoubleSide, GLSL3, ShaderMaterial, type IUniform } from "three";
import { deformShader, type DeformUniforms } from "./deform_shader";

/** The shader's numbers for the ways to colour a surface. */
export const shadings = { clay: 0, smooth: 1, flat: 2, texture: 3, "vertex-colours": 4 } as const;

/** The uniforms that all surfaces share. */
export interface LookUniforms {
  [name: string]: IUniform;
  shading: IUniform<number>;
  showRoles: IUniform<boolean>;
  cavity: IUniform<number>;
  selectionColour: IUniform<Color>;
  wireColour: IUniform<Color>;
  boundaryColour: IUniform<Color>;
  cutAbove: IUniform<Color>;
  cutBelow: IUniform<Color>;
}

export function lookUniforms(): LookUniforms {
  return {
    shading: { value: 0 },
    showRoles: { value: true },
    cavity: { value: 1 },
    selectionColour: { value: new Color(1.0, 0.5, 0.08) },
    wireColour: { value: new Color() },
    boundaryColour: { value: new Color() },
    cutAbove: { value: new Color(0.23, 0.49, 0.96) }, // blue and red, like the pane of the cutting plane
    cutBelow: { value: new Color(0.9, 0.28, 0.3) },
  };
}

const vertexShader = /* glsl */ `
${deformShader}
in vec4 tint;       // colours of roles, times their strength; alpha: that
in float selection;
uniform vec4 cutPlane;  // normal and offset, in the surface's own coordinates; 0: none
#ifdef HAS_COLOURS
  in vec3 colours;
#endif
#ifdef HAS_REST
  in vec3 rest;
#endif
#ifdef HAS_HEAT
  in float heat;
#endif
centroid out vec3 shownNormal, seenFrom;
out vec4 shownTint;
out float shownSelection, shownHeat, shownAbove;
out vec3 shownColour, shownRest;
out vec2 shownUv;

void main() {
  vec3 point, direction;
  deformVertex(point, direction);
  vec4 seen = modelViewMatrix * vec4(point, 1.0);
  shownNormal = normalMatrix * direction;
  seenFrom = seen.xyz;
  shownTint = tint;
  shownSelection = selection;
  shownAbove = dot(cutPlane.xyz, point) - cutPlane.w;
  shownHeat = 0.0;
  #ifdef HAS_HEAT
    shownHeat = heat;
  #endif
  shownColour = vec3(0.8);
  #ifdef HAS_COLOURS
    shownColour = colours;
  #endif
  shownUv = vec2(0.0);
  #ifdef HAS_UV
    shownUv = uv;
  #endif
  shownRest = vec3(0.0);
  #ifdef HAS_REST
    shownRest = rest;
  #endif
  gl_Position = projectionMatrix * seen;
}
`;

const lightShader = /* glsl */ `
// Clay under a large soft light from the upper left, a cool one from the right, and a thin bright rim.
vec3 clayLight(vec3 n) {
  float key = 0.5 + 0.5 * dot(n, normalize(vec3(-0.42, 0.62, 0.66)));
  float fill = max(0.0, dot(n, normalize(vec3(0.9, -0.15, 0.35))));
  float below = max(0.0, -n.y);
  vec3 light = mix(vec3(0.20, 0.19, 0.23), vec3(1.03, 0.99, 0.94), smoothstep(0.02, 1.0, key));
  light += fill * fill * vec3(0.05, 0.08, 0.14) + below * vec3(0.05, 0.035, 0.02);
  return light + 0.10 * pow(1.0 - clamp(n.z, 0.0, 1.0), 3.0);
}
float clayGloss(vec3 n) {
  vec3 h = normalize(vec3(-0.30, 0.50, 1.15));
  return 0.13 * pow(max(0.0, dot(n, h)), 36.0) + 0.05 * pow(max(0.0, dot(n, h)), 8.0);
}
vec3 plainLight(vec3 n) {
  return vec3(0.32 + 0.72 * clamp(dot(n, normalize(vec3(-0.2, 0.35, 0.92))), 0.0, 1.0));
}
`;

const fragmentShader = /* glsl */ `
centroid in vec3 shownNormal, seenFrom;
in vec4 shownTint;
in float shownSelection, shownHeat, shownAbove;
in vec3 shownColour, shownRest;
in vec2 shownUv;
uniform int shading;
uniform bool showRoles, hasHeat, linear, hasCut;
uniform float cavity, checkSize;
uniform vec3 selectionColour, cutAbove, cutBelow;
uniform sampler2D heatColours;
uniform vec2 heatRange;
uniform sampler2D picture;
uniform bool hasPicture;
out vec4 colour;
${lightShader}

// Returns whether the outside is seen. At a silhouette, slivers of triangles that face away show through gaps of a pixel;
// their normals tell them from an inside.
bool isOutside() {
  return gl_FrontFacing || dot(shownNormal, seenFrom) < 0.5 * length(shownNormal) * length(seenFrom);
}

vec3 surfaceNormal() {
  vec3 flatNormal = normalize(cross(dFdx(seenFrom), dFdy(seenFrom)));  // towards the camera
  if (shading == 2 || dot(shownNormal, shownNormal) < 1e-12) return flatNormal;
  return isOutside() ? normalize(shownNormal) : -normalize(shownNormal);
}

// Returns the curvature across the pixel: below 0 in grooves, above 0 on ridges.
float curvature(vec3 n) {
  vec3 across = dFdx(seenFrom), down = dFdy(seenFrom);
  float bend = dot(dFdx(n), across) / max(1e-20, dot(across, across)) + dot(dFdy(n), down) / max(1e-20, dot(down, down));
  return bend * length(across);
}

float checks(vec3 p) {
  vec3 s = sign(fract(p) - 0.5);
  return 0.5 + 0.5 * s.x * s.y * s.z;
}

vec3 ownColour() {
  vec3 clay = isOutside() ? vec3(0.80, 0.765, 0.72) : vec3(0.55, 0.60, 0.68);
  if (shading == 4) return shownColour;
  if (shading != 3) return clay;
  #ifdef HAS_UV
    if (hasPicture) return texture(picture, shownUv).rgb;
    float check = checks(vec3(shownUv * 16.0, 0.25));
  #else
    float check = checks(shownRest / checkSize);
  #endif
  return mix(vec3(0.36, 0.45, 0.55), vec3(0.90, 0.88, 0.83), check);
}

void main() {
  vec3 n = surfaceNormal();
  vec3 own = ownColour();
  if (hasHeat)
    own = texture(heatColours, vec2((shownHeat - heatRange.x) / max(1e-30, heatRange.y - heatRange.x), 0.5)).rgb;
  if (showRoles && !hasHeat) own = own * (1.0 - shownTint.a) + shownTint.rgb;
  if (hasCut) own = mix(own, shownAbove > 0.0 ? cutAbove : cutBelow, 0.55);
  own = mix(own, selectionColour, 0.85 * smoothstep(0.05, 0.75, shownSelection));
  bool clay = shading == 0 && !hasHeat;
  vec3 lit = own * (clay ? clayLight(n) : plainLight(n));
  if (clay) lit += clayGloss(n);
  if (cavity > 0.0 && shading != 2) {
    float k = clamp(4.0 * curvature(n), -1.0, 1.0);
    lit *= 1.0 + cavity * (k < 0.0 ? 0.35 * k : 0.22 * k);
  }
  colour = vec4(lit, 1.0);
}
`;

/** Makes the material of a surface. `defines` tell the shader which attributes exist; see `Surface`. */
export function surfaceMaterial(
  look: LookUniforms,
  deform: DeformUniforms,
  own: Record<string, IUniform>,
): ShaderMaterial {
  return new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms: { ...look, ...deform, ...own },
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}
