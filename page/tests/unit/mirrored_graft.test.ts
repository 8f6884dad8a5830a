import { Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { mirroredGraft, reflectionAt } from "../../src/app/graft/mirrored_graft";
import type { GraftFields } from "../../src/app/graft/graft_step";
import type { Plane } from "../../src/app/mirror_plane";

const plane: Plane = { point: [1, 0, 0], normal: [2, 0, 0] };
const none = { starts: [], loops: [], positionOf: (): [number, number, number] => [0, 0, 0] };

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

  it("joins the loop on the other side, with the start across the plane", () => {
    const ring = (x: number) => Array.from({ length: 8 }, (_, i) => [x, Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)]);
    const positions = [...ring(3), ...ring(-1), ...ring(-6)];
    const positionOf = (v: number) => positions[v] as [number, number, number];
    const loops = [Uint32Array.from({ length: 8 }, (_, i) => 16 + i), Uint32Array.from({ length: 8 }, (_, i) => 8 + i)];
    const pair = { source_loop: { loop: 4 }, target_loop: { loop: 1 }, matches: [[6, 5]] as [number, number][] };
    const graft = { fields: { source: "arm", pairs: [pair] }, starts: [[7, 2]] as [number, number][], loops, positionOf };
    expect(mirroredGraft(graft, plane)?.pairs).toEqual([
      { source_loop: { loop: 4 }, target_loop: { loop: 1 }, start: [7, 10], matches: [[6, 13]] },
    ]);
    expect(mirroredGraft({ ...graft, loops: loops.slice(0, 1) }, plane)).toBeUndefined();
  });
});
