import { OrthographicCamera, PerspectiveCamera, Quaternion, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { ScreenCamera, ScreenPoint } from "../../src/tools/screen_camera";
import { Gesture, type Axis, type Grip } from "../../src/tools/gesture";
import { bestHome, pointsUnder } from "../../src/tools/clear_bars";
import { layOut, partAt, shifted, viewRingPx, type Layout, type Part } from "../../src/tools/gizmo_layout";
import { gizmoScale, gizmoShift } from "../../src/tools/gizmo_size";
import { NumberEntry } from "../../src/tools/number_entry";
import { atRest, axesOf, centreOf, matrixOf, turned, type Motion, type Placement } from "../../src/tools/pose_math";
import { CanvasCamera } from "./screen_camera";

const box = { x: 10, y: 20, width: 1000, height: 800 } as DOMRect;

function cameras(): ScreenCamera[] {
  const perspective = new PerspectiveCamera(35, 1.25, 0.1, 100);
  const orthographic = new OrthographicCamera(-2.5, 2.5, 2, -2, 0.1, 100);
  return [perspective, orthographic].map((camera) => {
    camera.position.set(4, 3, 5);
    camera.lookAt(0, 0, 0);
    camera.updateMatrixWorld();
    camera.updateProjectionMatrix();
    return new CanvasCamera(() => camera, () => ({ getBoundingClientRect: () => box }));
  });
}

const rest = atRest(new Vector3(0.2, 0.1, -0.3));
const tilted = turned(rest, { axis: new Vector3(1, 2, 2).normalize(), angleDeg: 50 });
const world = new Quaternion();

function begin(camera: ScreenCamera, grip: Grip, from: Vector3, start: Placement = rest, axes = world): Gesture {
  return new Gesture(grip, start, axes, camera, camera.project(from));
}

function apart(a: ScreenPoint, b: ScreenPoint): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}

describe("a move", () => {
  it("keeps what was taken under the pointer", () => {
    for (const camera of cameras())
      for (const axis of [0, 1, 2, "free"] as const) {
        const centre = centreOf(tilted);
        const axes = axesOf(tilted);
        const gesture = begin(camera, { kind: "move", axis }, centre, tilted, axes);
        const direction = axis === "free" ? camera.towards(centre).cross(new Vector3(0, 1, 0)).normalize()
                                          : new Vector3().setComponent(axis, 1).applyQuaternion(axes);
        const goal = centre.clone().addScaledVector(direction, 0.7);
        gesture.pointAt(camera.project(goal));
        expect(apart(camera.project(centreOf(gesture.placement())), camera.project(goal))).toBeLessThan(1e-6);
        if (axis !== "free") expect(centreOf(gesture.placement()).distanceTo(goal)).toBeLessThan(1e-9);
      }
  });

  it("in a plane stays in it", () => {
    for (const camera of cameras()) {
      const gesture = begin(camera, { kind: "move", axis: 1, across: true }, centreOf(rest));
      gesture.pointAt({ x: 600, y: 500 });
      const shift = centreOf(gesture.placement()).sub(centreOf(rest));
      expect(Math.abs(shift.y)).toBeLessThan(1e-12);
      expect(shift.length()).toBeGreaterThan(0.1);
    }
  });

  it("goes in steps, and by the number that is typed", () => {
    const [camera] = cameras() as [ScreenCamera];
    const gesture = begin(camera, { kind: "move", axis: 0 }, centreOf(rest));
    gesture.pointAt(camera.project(centreOf(rest).add(new Vector3(0.77, 0, 0))));
    gesture.steps = { move: 0.25, turnDeg: 15, scale: 0.1 };
    expect(centreOf(gesture.placement()).x - centreOf(rest).x).toBeCloseTo(0.75, 12);
    for (const key of "-1.5") gesture.number.press(key);
    expect(centreOf(gesture.placement()).x - centreOf(rest).x).toBeCloseTo(-1.5, 12);
    expect(gesture.label("mm")).toBe("Move along X  -1.50 mm  [-1.5]");
  });
});

describe("a turn", () => {
  it("counts turns as the pointer goes round and round", () => {
    for (const camera of cameras())
      for (const [axis, sign] of [[0, 1], [1, 1], [2, 1], ["free", 1]] as [Axis | "free", number][]) {
        const gesture = begin(camera, { kind: "turn", axis }, new Vector3(9, 9, 9));
        const normal = gesture.turnAxis();
        const u = normal.clone().cross(new Vector3(0.3, 0.9, -0.2)).normalize();
        const v = normal.clone().cross(u);
        const onRing = (degrees: number) => {
          const angle = (degrees * Math.PI) / 180;
          return camera.project(centreOf(rest).addScaledVector(u, 0.4 * Math.cos(angle)).addScaledVector(v, 0.4 * Math.sin(angle)));
        };
        const turning = new Gesture({ kind: "turn", axis }, rest, world, camera, onRing(0));
        for (let degrees = 5; degrees <= 1000; degrees += 5) turning.pointAt(onRing(degrees));
        expect(turning.angleDeg()).toBeCloseTo(sign * 1000, 3);
        expect((turning.placement() as Motion).turn.angleDeg).toBeCloseTo(sign * 1000, 3);
      }
  });

  it("goes on where its ring is seen from the edge", () => {
    const [camera] = cameras() as [ScreenCamera];
    const sight = camera.towards(centreOf(rest));
    const axes = new Quaternion().setFromUnitVectors(new Vector3(1, 0, 0), sight.clone().cross(new Vector3(0, 1, 0)).normalize());
    const ring: Grip = { kind: "turn", axis: 0 };
    const axis = new Vector3(1, 0, 0).applyQuaternion(axes);
    const near = centreOf(rest).addScaledVector(sight, -0.1); // is in front, so it turns with the pointer
    const gesture = begin(camera, ring, near, rest, axes);
    const ahead = near.clone().addScaledVector(axis.clone().cross(sight).negate(), 0.05);
    gesture.pointAt(camera.project(ahead));
    expect(gesture.angleDeg()).toBeGreaterThan(1);
    const moved = near.clone().applyMatrix4(matrixOf(gesture.placement())).sub(near);
    expect(moved.dot(ahead.clone().sub(near))).toBeGreaterThan(0);
  });
});

describe("a scale", () => {
  it("doubles where the pointer is twice as far", () => {
    for (const camera of cameras()) {
      const c = camera.project(centreOf(rest));
      const all = new Gesture({ kind: "scale", axis: "free" }, rest, world, camera, { x: c.x + 60, y: c.y - 80 });
      all.pointAt({ x: c.x + 120, y: c.y - 160 });
      expect((all.placement() as Motion).scale.toArray()).toEqual([2, 2, 2].map((n) => expect.closeTo(n, 9)));
      all.pointAt(c);
      expect((all.placement() as Motion).scale.x).toBe(0.01);
    }
  });

  it("of one axis leaves the others, and one across it leaves that one", () => {
    const [camera] = cameras() as [ScreenCamera];
    const gesture = begin(camera, { kind: "scale", axis: 1 }, centreOf(rest));
    gesture.number.press("3");
    expect((gesture.placement() as Motion).scale.toArray()).toEqual([1, 3, 1]);
    gesture.constrain({ kind: "scale", axis: 1, across: true }, world);
    expect((gesture.placement() as Motion).scale.toArray()).toEqual([3, 1, 3]);
  });
});

describe("a typed number", () => {
  it("takes digits, a point or a comma, a sign at any time, and takes back", () => {
    const entry = new NumberEntry();
    for (const key of [".", "5", "-"]) expect(entry.press(key)).toBe(true);
    expect(entry.value).toBe(-0.5);
    for (const key of ["Backspace", "2", ",", "5", "."]) entry.press(key);
    expect(entry.text).toBe("-0.25");
    expect(entry.press("x")).toBe(false);
    for (let i = 0; i < 5; ++i) entry.press("Backspace");
    expect(entry.value).toBeUndefined();
    expect(entry.text).toBe("");
  });
});

describe("the gizmo", () => {
  it("gives each of its parts where it is drawn", () => {
    for (const camera of cameras())
      for (const axes of [world, axesOf(tilted)]) {
        const layout = layOut(centreOf(rest), axes, camera);
        expect(layout.parts.length).toBe(3 + 4 * 3);
        for (const part of layout.parts.filter(({ kind }) => ["ball", "box", "knob"].includes(kind)))
          expect(partAt(layout, part.outline[0] as ScreenPoint)?.id).toBe(part.id);
        for (const part of layout.parts.filter(({ kind }) => kind === "arrow"))
          expect(partAt(layout, part.outline[1] as ScreenPoint)?.id).toBe(part.id);
        expect(partAt(layout, { x: layout.centre.x + 300, y: layout.centre.y })).toBeUndefined();
      }
  });

  it("has the same size wherever it is", () => {
    for (const camera of cameras())
      for (const centre of [new Vector3(), new Vector3(-3, -2, -4)]) {
        const layout = layOut(centre, world, camera);
        const boxes = layout.parts.filter(({ kind }) => kind === "box").map(({ outline }) => outline[0] as ScreenPoint);
        for (const point of boxes) expect(apart(point, layout.centre)).toBeLessThan(135);
        expect(Math.max(...boxes.map((point) => apart(point, layout.centre)))).toBeGreaterThan(70);
      }
  });

  it("gives a square where it lies beside an arrow", () => {
    for (const camera of cameras()) {
      const layout = layOut(centreOf(rest), world, camera);
      for (const { id, outline } of layout.parts.filter(({ kind }) => kind === "square")) {
        const middle = { x: outline.reduce((sum, { x }) => sum + x / 4, 0), y: outline.reduce((sum, { y }) => sum + y / 4, 0) };
        expect(partAt(layout, middle)?.id).toBe(id);
      }
    }
  });

  it("hides arrows that point at the camera", () => {
    const [camera] = cameras() as [ScreenCamera];
    const centre = new Vector3();
    const axes = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), camera.towards(centre).negate());
    const ids = layOut(centre, axes, camera).parts.map(({ id }) => id);
    expect(ids).not.toContain("arrow-z");
    expect(ids).toContain("square-z");
    expect(ids).not.toContain("square-x");
  });
});

describe("the size of the gizmo", () => {
  const view = { viewWidth: 900, viewHeight: 700, isCoarse: false };
  it("fits what it moves, and keeps its grips apart", () => {
    const sizes = [0, 60, 90, 100, 110, 400].map((movedPx) => gizmoScale({ ...view, movedPx }));
    sizes.slice(1).forEach((size, k) => expect(size).toBeGreaterThanOrEqual(sizes[k] as number));
    expect(sizes[0]).toBeGreaterThan(0.6);
    expect(sizes.at(-1)).toBe(1);
    expect(gizmoScale({ ...view, movedPx: undefined })).toBe(1);
  });
  it("is larger for fingers, and smaller in a small view", () => {
    expect(gizmoScale({ ...view, movedPx: 5, isCoarse: true })).toBe(1);
    expect(gizmoScale({ ...view, viewWidth: 260, movedPx: 500 })).toBeLessThan(0.9);
  });
  it("lays its parts out in proportion", () => {
    for (const camera of cameras()) {
      const [usual, small] = [1, 0.75].map((scale) => layOut(centreOf(rest), world, camera, scale)) as [Layout, Layout];
      usual.parts.forEach(({ id, outline }, k) => {
        const part = small.parts[k] as Part;
        expect(part.id).toBe(id);
        if (id !== "ball") expect(apart(part.outline[0] as ScreenPoint, small.centre)).toBeLessThan(0.9 * apart(outline[0] as ScreenPoint, usual.centre) + 1);
      });
    }
  });
  it("is drawn within the view, unless its centre is outside", () => {
    const box = { left: 50, right: 850, top: 40, bottom: 640 };
    expect(gizmoShift({ x: 400, y: 300 }, 1, box)).toEqual({ x: 0, y: 0 });
    expect(gizmoShift({ x: 20, y: 300 }, 1, box)).toEqual({ x: 0, y: 0 });
    const { x, y } = gizmoShift({ x: 840, y: 50 }, 1, box);
    expect(840 + x + viewRingPx).toBeLessThan(box.right);
    expect(50 + y - viewRingPx).toBeGreaterThan(box.top);
    const moved = shifted(layOut(centreOf(rest), world, cameras()[0] as ScreenCamera), { x, y });
    for (const part of moved.parts.filter(({ kind }) => kind === "box")) expect(partAt(moved, part.outline[0] as ScreenPoint)?.id).toBe(part.id);
  });
});

describe("bars over the view", () => {
  const bar = { left: 0, right: 200, top: 0, bottom: 40 };
  it("count the grips below them, with the width of a grip", () => {
    expect(pointsUnder([{ x: 100, y: 20 }, { x: 205, y: 45 }, { x: 230, y: 20 }], [bar])).toBe(2);
  });
  it("go to the first of their homes that covers least", () => {
    const covers: Record<string, number> = { top: 3, low: 0, left: 0 };
    expect(bestHome(["top", "low", "left"], (home) => covers[home] ?? 0)).toBe("low");
    expect(bestHome(["top", "low"], () => 2)).toBe("top");
  });
});
