import { Matrix4, Quaternion, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import {
  atRest, axesOf, centreOf, composeTurns, matrixOf, mirrored, moved, placementOf, poseOf, scaled, turned, withPivot,
  withPivotAt, type Motion, type Placement, type Turn,
} from "../../src/tools/pose_math";

const x = new Vector3(1, 0, 0);
const y = new Vector3(0, 1, 0);
const world = new Quaternion();
const pivot = new Vector3(0.3, -1.2, 2);
const about = (axis: Vector3, angleDeg: number): Turn => ({ axis: axis.clone().normalize(), angleDeg });

/** Returns placements of many kinds: none, moved, turned far, scaled per axis, sheared. */
function placements(): Placement[] {
  const tilted = turned(moved(atRest(pivot), new Vector3(1, 2, 3)), about(new Vector3(1, 2, -1), 40));
  return [
    atRest(pivot),
    tilted,
    turned(atRest(pivot), about(x, 790)),
    scaled(tilted, new Vector3(2, 1, 0.5), axesOf(tilted)),
    scaled(tilted, new Vector3(2, 1, 0.5), world),
  ];
}

function expectSame(a: Matrix4, b: Matrix4, digits = 10): void {
  a.elements.forEach((value, i) => expect(value).toBeCloseTo(b.elements[i] ?? NaN, digits));
}

function rotation({ axis, angleDeg }: Turn): Matrix4 {
  return new Matrix4().makeRotationAxis(axis, (angleDeg * Math.PI) / 180);
}

function aroundCentre(placement: Placement, linear: Matrix4): Matrix4 {
  const c = centreOf(placement);
  const there = new Matrix4().setPosition(c);
  const back = new Matrix4().setPosition(c.clone().negate());
  return there.multiply(linear).multiply(back).multiply(matrixOf(placement));
}

describe("a pose", () => {
  it("is x' = c + t + R S (x - c)", () => {
    const placement = placementOf({ translate: [1, 0, 0], rotate: { axis: [0, 0, 2], angle_deg: 90 },
                                    scale: [2, 1, 1], pivot: [1, 1, 0] }, pivot);
    const mapped = new Vector3(2, 1, 0).applyMatrix4(matrixOf(placement as Motion));
    expect(mapped.distanceTo(new Vector3(2, 3, 0))).toBeLessThan(1e-12);
  });

  it("comes back from its placement as it was, and without what it need not say", () => {
    for (const placement of placements()) {
      const pose = poseOf(placement, pivot);
      expectSame(matrixOf(placementOf(pose, pivot) as Placement), matrixOf(placement), 12);
    }
    expect(poseOf(atRest(pivot), pivot)).toEqual({});
    expect(poseOf(scaled(atRest(pivot), new Vector3(1.5, 1.5, 1.5), world), pivot)).toEqual({ scale: 1.5 });
  });

  it("of a redrawn curve is moved and turned as a whole", () => {
    const drawn = placementOf({ curve: [[0, 0, 0], [2, 0, 0]] }, pivot);
    expect(drawn && centreOf(drawn).toArray()).toEqual([1, 0, 0]);
    expect(drawn && poseOf(drawn, pivot)).toEqual({ curve: [[0, 0, 0], [2, 0, 0]] });
    const up = drawn && moved(drawn, new Vector3(0, 0, 1));
    expect(up && poseOf(up, pivot)).toEqual({ curve: [[0, 0, 1], [2, 0, 1]] });
    const across = drawn && turned(drawn, { axis: new Vector3(0, 0, 1), angleDeg: 90 });
    const [first, last] = (across && poseOf(across, pivot).curve) ?? [];
    [1, -1, 0].forEach((x, k) => expect(first?.[k as 0]).toBeCloseTo(x, 12));
    [1, 1, 0].forEach((x, k) => expect(last?.[k as 0]).toBeCloseTo(x, 12));
  });
  it("from a file has no placement", () => {
    expect(placementOf({ def: "turn.def" }, pivot)).toBeUndefined();
  });
});

describe("gestures", () => {
  it("act in the world, about where the pivot is", () => {
    for (const placement of placements()) {
      const shift = new Vector3(0.5, -1, 2);
      expectSame(matrixOf(moved(placement, shift)), new Matrix4().setPosition(shift).multiply(matrixOf(placement)));
      const turn = about(new Vector3(-1, 0.2, 3), 250);
      expectSame(matrixOf(turned(placement, turn)), aroundCentre(placement, rotation(turn)));
      const factors = new Vector3(1.5, 0.7, 1);
      expectSame(matrixOf(scaled(placement, factors, world)),
                 aroundCentre(placement, new Matrix4().makeScale(1.5, 0.7, 1)));
    }
  });

  it("scale along own axes without shear, whatever came before", () => {
    const tilted = turned(scaled(atRest(pivot), new Vector3(2, 1, 1), world), about(new Vector3(1, 2, -1), 400));
    const twice = scaled(tilted, new Vector3(1, 3, 1), axesOf(tilted));
    expect(twice.kind).toBe("motion");
    expect((twice as Motion).scale.distanceTo(new Vector3(2, 3, 1))).toBeLessThan(1e-9);
    expect((twice as Motion).turn.angleDeg).toBe(400);
  });

  it("scale along the world's axes where a right angle allows it, else shear", () => {
    const quarter = turned(atRest(pivot), about(new Vector3(0, 0, 1), 90));
    const long = scaled(quarter, new Vector3(2, 1, 1), world);
    expect(long.kind).toBe("motion");
    expect((long as Motion).scale.distanceTo(new Vector3(1, 2, 1))).toBeLessThan(1e-9);
    const tilted = turned(atRest(pivot), about(x, 30));
    expect(scaled(tilted, new Vector3(1, 2, 1), world).kind).toBe("affine");
    expect(scaled(tilted, new Vector3(2, 2, 2), world).kind).toBe("motion");
  });
});

describe("turns", () => {
  it("about one axis add up, back and forth", () => {
    expect(composeTurns(about(x, 350), about(x, 370)).angleDeg).toBe(720);
    expect(composeTurns(about(x, 720), about(x.clone().negate(), 90)).angleDeg).toBe(630);
    expect(composeTurns(about(x, 0), about(y, 540))).toEqual(about(y, 540));
  });

  it("about different axes are the product of rotations", () => {
    for (const first of [about(x, 30), about(x, -200), about(new Vector3(1, 1, 0), 1000)])
      for (const then of [about(y, 10), about(y, -170), about(new Vector3(1, 2, 3), 500)])
        expectSame(rotation(composeTurns(first, then)), rotation(then).multiply(rotation(first)));
  });

  it("keep the whole turns of the first, and change smoothly with the second", () => {
    for (const first of [about(x, 30), about(x, -100), about(x, 750), about(x, -800)]) {
      let last = first;
      for (let angle = 1; angle <= 720; ++angle) {
        const next = composeTurns(first, about(y, angle));
        const step = next.axis.clone().multiplyScalar(next.angleDeg).distanceTo(
          last.axis.clone().multiplyScalar(last.angleDeg));
        expect(step).toBeLessThan(60);
        expect(Math.floor(next.angleDeg / 360)).toBe(Math.floor(Math.abs(first.angleDeg) / 360));
        last = next;
      }
    }
  });
});

describe("the pivot", () => {
  it("moves without moving the handle", () => {
    for (const placement of placements()) {
      const point = new Vector3(3, 1, -2);
      const shown = withPivotAt(placement, point);
      expectSame(matrixOf(shown), matrixOf(placement), 9);
      expect(centreOf(shown).distanceTo(point)).toBeLessThan(1e-9);
      const back = withPivot(shown, pivot);
      expectSame(matrixOf(back), matrixOf(placement), 9);
      expect(back.pivot.distanceTo(pivot)).toBe(0);
    }
  });
});

describe("the twin beyond a mirror", () => {
  const planes = [
    { point: new Vector3(0.5, 0, 0), normal: x },
    { point: new Vector3(1, 2, 3), normal: new Vector3(1, 1, 0.5).normalize() },
  ];

  it("does what the handle does, mirrored", () => {
    for (const plane of planes)
      for (const placement of placements()) {
        const twin = matrixOf(mirrored(placement, plane));
        for (const point of [new Vector3(1, 0, 0), new Vector3(0.2, 3, -1), pivot]) {
          const reflect = (p: Vector3) =>
            p.clone().addScaledVector(plane.normal, -2 * p.clone().sub(plane.point).dot(plane.normal));
          const expected = reflect(point.clone().applyMatrix4(matrixOf(placement)));
          expect(reflect(point).applyMatrix4(twin).distanceTo(expected)).toBeLessThan(1e-9);
        }
      }
  });

  it("keeps turns beyond 360°", () => {
    const [plane] = planes;
    const twin = mirrored(turned(atRest(pivot), about(y, 790)), plane as NonNullable<typeof plane>) as Motion;
    expect(twin.turn.angleDeg).toBe(-790);
    expect(twin.turn.axis.distanceTo(y)).toBeLessThan(1e-12);
  });
});
