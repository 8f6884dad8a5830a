import { Matrix4, Vector3 } from "three";
import type { Navigation } from "./navigation";

/** The side from which the model is seen. */
export type Side = "front" | "back" | "left" | "right" | "top" | "bottom";

/**
 * Returns the direction and the up vector of the view from a side, for a turntable with these axes (front, right, up).
 */
export function viewFrom(side: Side, [front, right, above]: readonly Vector3[]): { direction: Vector3; up: Vector3 } {
  const to = {
    front,
    back: front?.clone().negate(),
    right,
    left: right?.clone().negate(),
    top: above,
    bottom: above?.clone().negate(),
  };
  const towardsCamera = to[side] ?? new Vector3(0, 0, 1);
  const upright = side === "top" ? front?.clone().negate() : side === "bottom" ? front : above;
  return { direction: towardsCamera.clone().negate(), up: upright?.clone() ?? new Vector3(0, 1, 0) };
}

const sides: readonly Side[] = ["front", "back", "right", "left", "top", "bottom"];
const half = 29; // pixels

const alignedCosine = 0.9999; // of the angle within which the view counts as one from a side

/**
 * A cube in a corner that turns with the view. Its faces, edges and corners select viewing directions by the pointer.
 * For the keyboard and screen readers it is one control, a group of radio buttons with the names of the six sides.
 */
export class ViewCube {
  readonly element = document.createElement("div");
  private readonly turning = document.createElement("div");
  private readonly radios = new Map<Side, HTMLInputElement>();
  /** Holds the menu of the cube. It stands right after the cube. */
  readonly menu = document.createElement("div");
  private builtFor = "";
  private press: { x: number; y: number; moved: boolean } | undefined;

  constructor(
    private readonly navigation: Navigation,
    private readonly look: (direction: Vector3, up?: Vector3) => void,
  ) {
    this.element.className = "view-cube";
    this.element.dataset["homes"] = "top low";
    this.element.title = "Click a face, edge or corner to view from there; drag to orbit";
    this.turning.className = "view-cube-turning";
    this.turning.ariaHidden = "true";
    this.element.append(this.sideChoice(), this.turning);
    this.menu.className = "view-cube-corner";
    this.element.addEventListener("pointerdown", (event) => this.begin(event));
    this.element.addEventListener("pointermove", (event) => this.drag(event));
    this.element.addEventListener(
      "pointerup",
      () => (this.press = this.press?.moved === true ? this.press : undefined),
    );
    this.element.addEventListener("click", (event) => this.swallow(event), true);
  }

  /** Turns the cube with the view. */
  update(): void {
    if (this.builtFor !== keyOf(this.navigation)) this.build();
    const m = new Matrix4().makeRotationFromQuaternion(this.navigation.orientation().invert());
    this.turning.style.transform = matrix3d(new Matrix4().makeScale(1, -1, 1).multiply(m));
    this.checkSide();
  }

  /** Makes the radio buttons. They are hidden for the eye; the cube shows their focus. */
  private sideChoice(): HTMLElement {
    const group = document.createElement("div");
    group.className = "view-cube-sides hidden";
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", "View from");
    for (const side of sides) {
      const radio = document.createElement("input");
      radio.type = "radio";
      radio.name = "view-side";
      radio.setAttribute("aria-label", nameOf(side));
      radio.addEventListener("change", () => this.lookFrom(side));
      radio.addEventListener("click", () => this.lookFrom(side)); // also where it is chosen already
      this.radios.set(side, radio);
      group.append(radio);
    }
    return group;
  }

  private lookFrom(side: Side): void {
    const { direction, up } = viewFrom(side, this.navigation.axes());
    this.look(direction, up);
  }

  /** Chooses the radio button of the side that the model is seen from, if it is seen from one. */
  private checkSide(): void {
    const towardsCamera = new Vector3(0, 0, 1).applyQuaternion(this.navigation.orientation());
    for (const [side, radio] of this.radios) {
      const { direction } = viewFrom(side, this.navigation.axes());
      radio.checked = -direction.dot(towardsCamera) > alignedCosine;
    }
  }

  private build(): void {
    this.builtFor = keyOf(this.navigation);
    this.turning.replaceChildren(...sides.map((side) => this.face(side)));
  }

  private face(side: Side): HTMLElement {
    const { direction, up } = viewFrom(side, this.navigation.axes());
    const normal = direction.negate();
    const right = new Vector3().crossVectors(up, normal);
    const face = document.createElement("div");
    face.className = "view-cube-face";
    const matrix = new Matrix4()
      .makeBasis(right, up.clone().negate(), normal)
      .setPosition(normal.clone().multiplyScalar(half));
    face.style.transform = matrix3d(matrix);
    for (let j = 1; j >= -1; --j)
      for (let i = -1; i <= 1; ++i) {
        const towardsCamera = normal.clone().addScaledVector(right, i).addScaledVector(up, j);
        face.append(this.cell(i === 0 && j === 0 ? side : undefined, towardsCamera, up));
      }
    return face;
  }

  private cell(side: Side | undefined, towardsCamera: Vector3, up: Vector3): HTMLElement {
    const cell = document.createElement("div");
    cell.className = "view-cube-cell";
    if (side !== undefined) cell.textContent = nameOf(side);
    cell.addEventListener("click", () => this.look(towardsCamera.clone().negate(), up));
    return cell;
  }

  private begin(event: PointerEvent): void {
    this.press = { x: event.clientX, y: event.clientY, moved: false };
  }

  private drag(event: PointerEvent): void {
    const { press } = this;
    if (press === undefined || event.buttons === 0) return;
    const dx = event.clientX - press.x;
    const dy = event.clientY - press.y;
    if (!press.moved && Math.hypot(dx, dy) < 4) return;
    if (!press.moved) this.element.setPointerCapture(event.pointerId);
    Object.assign(press, { x: event.clientX, y: event.clientY, moved: true });
    this.navigation.orbit(-dx * 0.02, dy * 0.02);
  }

  /** Suppresses the click at the end of a drag. */
  private swallow(event: Event): void {
    if (this.press?.moved === true) event.stopPropagation();
    this.press = undefined;
  }
}

function keyOf({ upright }: Navigation): string {
  return `${upright.up} ${upright.front}`;
}

function nameOf(side: Side): string {
  return side.charAt(0).toUpperCase() + side.slice(1);
}

function matrix3d(matrix: Matrix4): string {
  return `matrix3d(${matrix.elements.map((x) => x.toFixed(6)).join(",")})`;
}
