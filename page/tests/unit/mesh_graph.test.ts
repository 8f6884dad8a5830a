import { describe, expect, it } from "vitest";
import { MeshGraph, type MeshArrays } from "../../src/tools/mesh_graph";

/** Returns a sheet of n×n squares, two triangles each, folded by a right angle at x = fold. */
function sheet(n: number, fold = n, isSoup = false): MeshArrays {
  const position = (i: number, j: number) => (i <= fold ? [i, j, 0] : [fold, j, i - fold]);
  const positions: number[] = [];
  const triangles: number[] = [];
  const add = (...corners: [number, number][]) => {
    for (const [i, j] of corners)
      if (isSoup) {
        triangles.push(positions.length / 3);
        positions.push(...position(i, j));
      } else triangles.push((n + 1) * i + j);
  };
  if (!isSoup) for (let i = 0; i <= n; ++i) for (let j = 0; j <= n; ++j) positions.push(...position(i, j));
  for (let i = 0; i < n; ++i)
    for (let j = 0; j < n; ++j) {
      add([i, j], [i + 1, j], [i + 1, j + 1]);
      add([i, j], [i + 1, j + 1], [i, j + 1]);
    }
  return { positions: Float32Array.from(positions), triangles: Uint32Array.from(triangles) };
}

function graphOf(mesh: MeshArrays): MeshGraph {
  const work = MeshGraph.make(mesh);
  for (;;) {
    const { done, value } = work.next();
    if (done === true) return value as MeshGraph;
  }
}

describe("the graph of a mesh", () => {
  it("finds shortest paths along edges", () => {
    const graph = graphOf(sheet(6));
    const path = graph.path(0, 7 * 6 + 6) as Uint32Array;
    expect([...path]).toEqual([0, 8, 16, 24, 32, 40, 48]); // along the diagonals
    expect(graph.path(0, 6)?.length).toBe(7);
    expect(graph.path(3, 3)).toEqual(Uint32Array.of(3));
    expect(graph.path(0, 48, 3)).toBeUndefined();
  });

  it("measures along edges, round the fold", () => {
    const graph = graphOf(sheet(6, 3));
    const near = graph.within([0], 3.5);
    expect(near.get(7 * 3)).toBeCloseTo(3, 6);
    expect(near.has(7 * 4)).toBe(false);
    expect(graph.within([0], 100).get(7 * 6)).toBeCloseTo(6, 6);
  });

  it("floods up to a fold, or over it", () => {
    const graph = graphOf(sheet(6, 3));
    expect(graph.flood(0, 30).length).toBe(7 * 4);
    expect(graph.flood(0, 100).length).toBe(7 * 7);
    expect(graph.component(20).length).toBe(49);
  });

  it("finds the loop around it, and the boundary of a part", () => {
    const graph = graphOf(sheet(6));
    expect(graph.loops.map((loop) => loop.length)).toEqual([24]);
    const middle = Uint32Array.from([16, 17, 18, 23, 24, 25, 30, 31, 32]);
    expect(graph.boundaryOf(middle)).toEqual([16, 17, 18, 23, 25, 30, 31, 32]);
    expect(graph.boundaryOf(Uint32Array.from({ length: 49 }, (_, v) => v)).length).toBe(49);
  });

  it("takes triangles that lie side by side, but apart, as one surface", () => {
    const graph = graphOf(sheet(4, 4, true));
    expect(graph.loops.map((loop) => loop.length)).toEqual([16]);
    expect(graph.component(95).length).toBe(25);
    expect(graph.path(0, 95)?.length).toBe(5);
    expect(graph.facesInside(graph.component(0)).length).toBe(32);
  });
});
