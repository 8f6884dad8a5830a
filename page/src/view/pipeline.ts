import {
  DepthTexture,
  GLSL3,
  Matrix4,
  Mesh,
  OrthographicCamera,
  Scene,
  ShaderMaterial,
  UnsignedIntType,
  Vector2,
  WebGLRenderTarget,
} from "three";
import type { Camera, WebGLRenderer } from "three";
import { coveringTriangle } from "./backdrop";

/** The level of detail of a picture. */
export interface Detail {
  scale: number; // of the resolution, in both directions
  samples: number; // per pixel
  occlusion: boolean;
}

const coverShader = /* glsl */ `
out vec2 at;
void main() {
  at = 0.5 * position.xy + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

// Ambient occlusion from depths alone (after McGuire et al. 2011).
const occlusionShader = /* glsl */ `
in vec2 at;
uniform highp sampler2D depths;
uniform mat4 unprojection;
uniform vec2 pixel;
uniform float range, rangeInPicture;  // in the world; in heights of the picture, at depth 1 (or everywhere)
uniform bool isParallel;
out vec4 colour;

vec3 viewPosition(vec2 p) {
  vec4 position = unprojection * vec4(2.0 * vec3(p, textureLod(depths, p, 0.0).r) - 1.0, 1.0);
  return position.xyz / position.w;
}
vec3 least(vec3 a, vec3 b) { return abs(a.z) < abs(b.z) ? a : b; }

void main() {
  if (textureLod(depths, at, 0.0).r >= 1.0) {
    colour = vec4(1.0);
    return;
  }
  vec3 p = viewPosition(at);
  vec3 across = least(viewPosition(at + vec2(pixel.x, 0)) - p, p - viewPosition(at - vec2(pixel.x, 0)));
  vec3 up = least(viewPosition(at + vec2(0, pixel.y)) - p, p - viewPosition(at - vec2(0, pixel.y)));
  vec3 n = normalize(cross(across, up));
  float slant = dot(n, isParallel ? vec3(0, 0, 1) : normalize(-p));  // near 0 the normal is unreliable
  float radius = min(0.16, rangeInPicture / (isParallel ? 1.0 : -p.z));
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float turn = 6.2831853 * noise, start = fract(3.0 * noise + 0.5);
  float sum = 0.0;
  const int count = 11;
  for (int i = 0; i < count; ++i) {
    float far = (float(i) + start) / float(count);  // a random start avoids blotches of neighbouring pixels
    float angle = turn + 2.3999632 * float(i) * 1.7;
    vec2 shift = radius * far * vec2(cos(angle), sin(angle)) * vec2(pixel.x / pixel.y, 1.0);
    vec3 v = viewPosition(at + shift) - p;
    float square = dot(v, v);
    float f = max(0.0, 1.0 - square / (range * range));
    sum += f * f * f * max(0.0, (dot(v, n) - 0.012 * range) / sqrt(square + 1e-4 * range * range));
  }
  sum *= smoothstep(0.05, 0.3, slant);
  colour = vec4(vec3(clamp(1.0 - 2.4 * sum / float(count), 0.0, 1.0)), 1.0);
}
`;

const finishShader = /* glsl */ `
in vec2 at;
uniform sampler2D picture;
uniform highp sampler2D depths, occlusion;
uniform vec2 pixel;  // of the occlusion
uniform bool hasOcclusion;
out vec4 colour;

float nearOcclusion() {
  float middle = textureLod(depths, at, 0.0).r;
  float sum = 0.0, total = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      vec2 p = at + pixel * vec2(x, y);
      float like = exp(-180.0 * abs(textureLod(depths, p, 0.0).r - middle) / max(1e-4, 1.0 - middle)) + 1e-4;
      sum += like * textureLod(occlusion, p, 0.0).r;
      total += like;
    }
  return sum / total;
}

void main() {
  colour = vec4(texture(picture, at).rgb, 1.0);
  if (!hasOcclusion || textureLod(depths, at, 0.0).r >= 1.0) return;
  float open = nearOcclusion();
  colour.rgb *= mix(vec3(0.30, 0.27, 0.30), vec3(1.0), open);
}
`;

/** Draws a scene into a texture, darkens its folds by ambient occlusion, and puts the result onto the canvas. */
export class Pipeline {
  private readonly cover = new Mesh(coveringTriangle());
  private readonly coverScene = new Scene();
  private readonly flatCamera = new OrthographicCamera();
  private readonly occlusionPass = this.pass(occlusionShader, [
    "depths",
    "unprojection",
    "pixel",
    "range",
    "rangeInPicture",
    "isParallel",
  ]);
  private readonly finishPass = this.pass(finishShader, ["picture", "depths", "occlusion", "pixel", "hasOcclusion"]);
  private readonly targets = new Map<string, WebGLRenderTarget>();
  private readonly occlusion = new WebGLRenderTarget(1, 1, { depthBuffer: false });

  constructor(private readonly renderer: WebGLRenderer) {
    this.cover.frustumCulled = false;
    this.coverScene.add(this.cover);
  }

  /**
   * `range`: largest distance of an occluder, in world units; `worldPerHeight`: world height of the picture at depth 1.
   */
  render(scene: Scene, camera: Camera, detail: Detail, range: number, worldPerHeight: number): void {
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    const target = this.targetFor(size.multiplyScalar(detail.scale).ceil(), detail.samples);
    this.renderer.setRenderTarget(target);
    this.renderer.clear();
    this.renderer.render(scene, camera);
    if (detail.occlusion) this.occlude(target, camera, range, worldPerHeight);
    this.renderer.setRenderTarget(null);
    set(this.finishPass, {
      picture: target.texture,
      depths: target.depthTexture,
      occlusion: this.occlusion.texture,
      pixel: new Vector2(1 / this.occlusion.width, 1 / this.occlusion.height),
      hasOcclusion: detail.occlusion,
    });
    this.draw(this.finishPass);
  }

  dispose(): void {
    for (const target of this.targets.values()) target.dispose();
    this.occlusion.dispose();
  }

  private occlude(target: WebGLRenderTarget, camera: Camera, range: number, worldPerHeight: number): void {
    this.occlusion.setSize(Math.ceil(target.width / 2), Math.ceil(target.height / 2));
    set(this.occlusionPass, {
      depths: target.depthTexture,
      unprojection: new Matrix4().copy(camera.projectionMatrix).invert(),
      pixel: new Vector2(1 / this.occlusion.width, 1 / this.occlusion.height),
      range,
      rangeInPicture: range / worldPerHeight,
      isParallel: camera instanceof OrthographicCamera,
    });
    this.renderer.setRenderTarget(this.occlusion);
    this.draw(this.occlusionPass);
  }

  private draw(material: ShaderMaterial): void {
    this.cover.material = material;
    this.renderer.render(this.coverScene, this.flatCamera);
  }

  private targetFor(size: Vector2, samples: number): WebGLRenderTarget {
    const name = `${samples}`;
    let target = this.targets.get(name);
    if (target === undefined) {
      const depthTexture = new DepthTexture(size.x, size.y, UnsignedIntType);
      target = new WebGLRenderTarget(size.x, size.y, { samples, depthTexture });
      this.targets.set(name, target);
    }
    if (target.width !== size.x || target.height !== size.y) target.setSize(size.x, size.y);
    return target;
  }

  private pass(fragmentShader: string, names: string[]): ShaderMaterial {
    const uniforms = Object.fromEntries(names.map((name) => [name, { value: null }]));
    return new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: coverShader,
      fragmentShader,
      uniforms,
      depthTest: false,
      depthWrite: false,
    });
  }
}

function set(material: ShaderMaterial, values: Record<string, unknown>): void {
  for (const [name, value] of Object.entries(values)) Object.assign(material.uniforms[name] ?? {}, { value });
}
