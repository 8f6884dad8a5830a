import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLSL3,
  Mesh,
  PlaneGeometry,
  ShaderMaterial,
  Vector3,
} from "three";

/** The colours behind and around the model. */
export interface Theme {
  top: Color;
  bottom: Color;
  grid: Color;
  gridStrength: number;
  wire: Color;
  boundary: Color;
}

export const themes: Record<"light" | "dark", Theme> = {
  light: {
    top: new Color(0.955, 0.96, 0.965),
    bottom: new Color(0.8, 0.825, 0.85),
    grid: new Color(0.35, 0.4, 0.46),
    gridStrength: 0.42,
    wire: new Color(0.08, 0.1, 0.14),
    boundary: new Color(0.1, 0.42, 0.75),
  },
  dark: {
    top: new Color(0.2, 0.22, 0.25),
    bottom: new Color(0.09, 0.1, 0.115),
    grid: new Color(0.62, 0.68, 0.76),
    gridStrength: 0.3,
    wire: new Color(0.05, 0.06, 0.08),
    boundary: new Color(0.4, 0.75, 1.0),
  },
};

/** Returns a triangle that covers the whole picture. */
export function coveringTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  return geometry;
}

const coverShader = /* glsl */ `
out vec2 at;
void main() {
  at = 0.5 * position.xy + 0.5;
  gl_Position = vec4(position.xy, 1.0, 1.0);
}
`;

/** A soft gradient behind everything. */
export class Background {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  constructor() {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      depthTest: false,
      depthWrite: false,
      uniforms: { top: { value: new Color() }, bottom: { value: new Color() } },
      vertexShader: coverShader,
      fragmentShader: /* glsl */ `
        in vec2 at;
        uniform vec3 top, bottom;
        out vec4 colour;
        void main() {
          float t = smoothstep(-0.15, 1.0, at.y - 0.25 * dot(at - vec2(0.5, 0.6), at - vec2(0.5, 0.6)));
          float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
          colour = vec4(mix(bottom, top, t) + noise / 255.0, 1.0);
        }`,
    });
    this.mesh = new Mesh(coveringTriangle(), material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -10;
  }
  setTheme(theme: Theme): void {
    Object.assign(this.mesh.material.uniforms["top"] ?? {}, { value: theme.top });
    Object.assign(this.mesh.material.uniforms["bottom"] ?? {}, { value: theme.bottom });
  }
}

/** Returns 1, 2 or 5 times a power of ten: the largest such number that is at most `length`. */
export function roundLength(length: number): number {
  if (!(length > 0) || !Number.isFinite(length)) return 1;
  const power = 10 ** Math.floor(Math.log10(length));
  const digit = length / power;
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

/** A faint grid on the ground that fades away from the model. */
export class Ground {
  readonly mesh: Mesh<PlaneGeometry, ShaderMaterial>;
  constructor() {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      transparent: true,
      depthWrite: false,
      side: DoubleSide,
      uniforms: { colour: { value: new Color() }, strength: { value: 0.3 }, spacing: { value: 0.1 } },
      vertexShader: /* glsl */ `
        out vec2 at;
        void main() {
          at = position.xy;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: /* glsl */ `
        in vec2 at;
        uniform vec3 colour;
        uniform float strength, spacing;
        out vec4 result;
        float lines(float step) {
          vec2 p = at / step;
          vec2 away = abs(fract(p - 0.5) - 0.5), width = max(fwidth(p), vec2(1e-6));
          vec2 line = clamp(1.0 - away / width, 0.0, 1.0) * clamp(1.0 - 2.0 * width, 0.0, 1.0);
          return max(line.x, line.y);
        }
        void main() {
          float fade = 1.0 - smoothstep(0.25, 1.0, length(at));
          result = vec4(colour, strength * fade * max(0.45 * lines(spacing), lines(5.0 * spacing)));
        }`,
    });
    this.mesh = new Mesh(new PlaneGeometry(2, 2), material);
    this.mesh.renderOrder = 5;
    this.mesh.frustumCulled = false;
  }
  /**
   * Places the grid below a model. `middle` is a point on the ground, `up` its normal, `size` the model's size in model
   * units.
   */
  fitTo(middle: Vector3, up: Vector3, size: number): void {
    const radius = Math.max(1e-30, 2.2 * size);
    this.mesh.position.copy(middle);
    this.mesh.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), up);
    this.mesh.scale.setScalar(radius);
    Object.assign(this.mesh.material.uniforms["spacing"] ?? {}, { value: roundLength(size / 12) / radius });
  }
  setTheme(theme: Theme): void {
    Object.assign(this.mesh.material.uniforms["colour"] ?? {}, { value: theme.grid });
    Object.assign(this.mesh.material.uniforms["strength"] ?? {}, { value: theme.gridStrength });
  }
}
