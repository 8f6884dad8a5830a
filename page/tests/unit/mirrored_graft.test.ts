import { Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { mirroredGraft, reflectionAt } from "../../src/app/graft/mirrored_graft";
import type { GraftFields, Vector3Tuple } from "../../src/app/graft/graft_step";
import { LoopCurve } from "../../src/app/graft/loop_curve";
import type { Plane } from "../../src/app/mirror_plane";

const plane: Plane = { point: [1, 0, 0], normal: [2, 0, 0] };
const none = { starts: [], places: [], loops: [], partLoops: [], positionOf: (): Vector3Tuple => [0, 0, 0] };

/** Returns the map that a step applies to its part: the mirror, then the transform. */
function posing({ mirror, source_transform }: GraftFields): Matrix4 {
  const map = mirror == null ? new Matrix4() : reflectionAt(mirror);
  if (source_transform == null) return map;
  return map.premultiply(new Matrix4().set(...(source_transform.flat() as Parameters<Matrix4["set"]>)));
}

function expectSame(a: Matrix4, b: Matrix4): void {
  a.elements.forEach((x, i) => expect(x).toBeCloseTo(b.elements[i] as number, 9));
}

describe("the mirror image of a graft", () => {
  it("reflects at a plane", () => {
    expect(new Vector3(3, 1, 2).applyMatrix4(reflectionAt(plane)).toArray()).toEqual([-1, 1, 2]);
  });

  it("mirrors where a part is dropped, its spin and the tilt of its base", () => {
    const at = { point: [3, 1, 2] as [number, number, number], spin_deg: 30, base: { height: 0.2, tilt_deg: 10, tilt_axis: [0, 1, 0] as [number, number, number] } };
    const mirrored = mirroredGraft({ fields: { source: "horn", target: "bust", size: 2, at }, ...none }, plane);
    expect(mirrored).toEqual({
      source: "horn", size: 2, mirror: plane,
      at: { point: [-1, 1, 2], spin_deg: -30, base: { height: 0.2, tilt_deg: 10, tilt_axis: [expect.closeTo(0), -1, expect.closeTo(0)] } },
    });
  });

  it("poses the part as the mirror image of its pose, however that was given", () => {
    const turn = new Matrix4().makeRotationZ(0.4).setPosition(1, 2, 3).transpose().toArray();
    const rows = [0, 1, 2, 3].map((i) => turn.slice(4 * i, 4 * i + 4)) as NonNullable<GraftFields["source_transform"]>;
    const other: Plane = { point: [0, 0, 5], normal: [0, 1, 1] };
    for (const fields of [{}, { mirror: other }, { source_transform: rows }, { mirror: other, source_transform: rows }]) {
      const mirrored = mirroredGraft({ fields: { ...fields, at: { point: [0, 0, 0] } }, ...none }, plane);
      expectSame(posing(mirrored ?? {}), reflectionAt(plane).multiply(posing(fields)));
    }
  });

  /** Returns the corners of a circle about the x axis. */
  const ring = (x: number, count: number, turnDeg = 0) =>
    Array.from({ length: count }, (_, i): Vector3Tuple => {
      const angle = (2 * Math.PI * i) / count + (turnDeg * Math.PI) / 180;
      return [x, Math.cos(angle), Math.sin(angle)];
    });
  const loopOf = (positions: readonly Vector3Tuple[], first: number, count: number) =>
    new LoopCurve(Uint32Array.from({ length: count }, (_, i) => first + i), Float32Array.from(positions.flat()));

  it("joins the loop on the other side, with the start and the matches across the plane", () => {
    const positions = [...ring(3, 8), ...ring(-1, 8), ...ring(-6, 8)];
    const pair = { source_loop: { loop: 4 }, target_loop: { loop: 1 }, matches: [[6, 5]] as [number, number][] };
    const graft = {
      ...none,
      fields: { source: "arm", pairs: [pair] },
      starts: [[7, 2]] as [number, number][],
      loops: [loopOf(positions, 16, 8), loopOf(positions, 8, 8)],
      positionOf: (v: number) => positions[v] as Vector3Tuple,
    };
    expect(mirroredGraft(graft, plane)?.pairs).toEqual([
      { source_loop: { loop: 4 }, target_loop: { loop: 1 }, start: [7, 10], matches: [[6, 13]] },
    ]);
    expect(mirroredGraft({ ...graft, loops: graft.loops.slice(0, 1) }, plane)).toBeUndefined();
  });

  it("turns the copy as the mirror image of the part, although the vertices of the loops lie elsewhere", () => {
    const positions = [...ring(3, 8), ...ring(-1, 10, 7)];
    const part = ring(0, 12);
    const met = ([x, y, z] = [0, 0, 0]): Vector3Tuple => [x, y * Math.cos(0.2) - z * Math.sin(0.2), y * Math.sin(0.2) + z * Math.cos(0.2)];
    const graft = {
      ...none,
      fields: { source: "arm", pairs: [{ source_loop: { loop: 0 }, target_loop: { loop: 0 } }] },
      starts: [[5, 3]] as [number, number][],
      places: [[3, ...met(part[5]).slice(1)] as Vector3Tuple],
      loops: [loopOf(positions, 8, 10)],
      partLoops: [loopOf(part, 0, 12)],
      positionOf: (v: number) => positions[v] as Vector3Tuple,
    };
    const [source, target] = mirroredGraft(graft, plane)?.pairs?.[0]?.start as [number, number];
    const [, y, z] = met(part[source]);
    expect(new Vector3(-1, y, z).distanceTo(new Vector3(...(positions[target] as Vector3Tuple)))).toBeLessThan(0.03); // 1.5°
  });
});
