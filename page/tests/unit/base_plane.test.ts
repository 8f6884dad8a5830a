import { Matrix4, Quaternion, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { baseCorners, baseFrame, raised, tilted } from "../../src/tools/graft/base_plane";

const twice = new Matrix4().makeScale(2, 2, 2).setPosition(10, 0, 0);
const flat = { height: 0.5, point: [1, 0, 0] as const, normal: [0, 0, 1] as const };

describe("the plane that opens a dropped part", () => {
  test("is shown where the part is", () => {
    const frame = baseFrame(flat, {}, twice, 3);
    expect(frame.centre.toArray()).toEqual([12, 0, 0]);
    expect(frame.radius).toBeCloseTo(1.8);
    for (const corner of baseCorners(frame)) {
      expect(corner.z).toBeCloseTo(0);
      expect(corner.distanceTo(frame.centre)).toBeCloseTo(1.8 * Math.SQRT2);
    }
  });
  test("follows the pointer in height, in the part's own units, and stays above its lowest point", () => {
    const frame = baseFrame(flat, {}, twice, 3);
    expect(raised(frame, 0.4).height).toBeCloseTo(0.7);
    expect(raised(frame, -0.4).height).toBeCloseTo(0.3);
    expect(raised(frame, 0.4).centre.z).toBeCloseTo(0.4);
    expect(raised(frame, -99).height).toBeGreaterThan(0);
  });
  test("is raised by a larger tilt where its grip is", () => {
    for (const [up, axis] of [[[0, 0, 1], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]], [[0, -1, 0], [1, 0, 0]]] as const) {
      const frame = baseFrame({ ...flat, normal: up }, {}, new Matrix4(), 3);
      expect(frame.tiltAxis).toEqual(axis);
      const turned = tilted(frame, frame.radius);
      expect(turned.tiltDeg).toBe(45);
      expect(turned.towardsTilt.dot(frame.normal)).toBeCloseTo(Math.SQRT1_2);
      const turn = new Quaternion().setFromAxisAngle(new Vector3(...axis), Math.PI / 4);
      expect(turned.normal.distanceTo(new Vector3(...up).applyQuaternion(turn))).toBeLessThan(1e-12);
      expect(tilted(frame, -99 * frame.radius).tiltDeg).toBe(-60);
    }
  });
  test("has the axis that it was tilted about", () => {
    for (const [up, axis] of [[[0, 0, 1], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]]] as const)
      for (const tilt_deg of [20, -50]) {
        const turn = new Quaternion().setFromAxisAngle(new Vector3(...axis), (tilt_deg * Math.PI) / 180);
        const [x, y, z] = new Vector3(...up).applyQuaternion(turn).toArray();
        expect(baseFrame({ ...flat, normal: [x, y, z] }, { tilt_deg }, new Matrix4(), 3).tiltAxis).toEqual(axis);
      }
    expect(baseFrame(flat, { tilt_axis: [0, 1, 0] }, twice, 3).tiltAxis).toEqual([0, 1, 0]);
  });
});
