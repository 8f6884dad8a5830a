import {
  Box3,
  BoxGeometry,
  DoubleSide,
  Matrix4,
  Quaternion,
  Ray,
  Sphere,
  TorusGeometry,
  Vector3,
  type BufferGeometry,
} from "three";
import { MeshBVH } from "three-mesh-bvh";
import { afterAll, beforeAll, describe, expect, it, vi } from "vitest";
import { uprightOf } from "../../src/app/upright";
import { roundLength } from "../../src/view/backdrop";
import { colourAt, colourTable, diverging, rising } from "../../src/view/surface/colour_maps";
import { writeFrame } from "../../src/view/surface/deform_shader";
import { bendsOf, detailOf, heatRange, stretchOf } from "../../src/view/surface/heat";
import { coarseTriangles, edgesOf } from "../../src/view/surface/mesh_topology";
import { Navigation } from "../../src/view/navigation";
import { NormalsOfPart } from "../../src/view/surface/normals";
import { PolygonTest } from "../../src/view/picking/polygon";
import { matrixOfPose } from "../../src/view/pose_matrix";
import { raycastTriangles } from "../../src/view/picking/ray";
import { depthInRegion } from "../../src/view/surface/roles";
import { Slices } from "../../src/view/surface/slices";
import { runsOf, spanOfChange } from "../../src/view/surface/spans";
import { viewFrom } from "../../src/view/view_cube";
import { lengthText } from "../../src/view/view_notes";
import { textureSize } from "../../src/view/surface/weight_textures";

/** Returns a generator of numbers from 0 to 1, the same for the same seed. */
function randoms(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

function all<T>(work: Generator<void, T>): T {
  for (;;) {
    const next = work.next();
    if (next.done === true) return next.value;
  }
}

function arraysOf(geometry: BufferGeometry): { positions: Float32Array; triangles: Uint32Array } {
  const positions = Float32Array.from(geometry.getAttribute("position").array);
  return { positions, triangles: Uint32Array.from(geometry.getIndex()?.array ?? []) };
}

const torus = arraysOf(new TorusGeometry(1, 0.4, 24, 48));

/** Returns a flat sheet of n by n squares, each of side 1. */
function sheet(n: number): { positions: Float32Array; triangles: Uint32Array } {
  const positions: number[] = [];
  const triangles: number[] = [];
  for (let y = 0; y <= n; ++y) for (let x = 0; x <= n; ++x) positions.push(x, y, 0);
  for (let y = 0; y < n; ++y)
    for (let x = 0; x < n; ++x) {
      const a = y * (n + 1) + x;
      triangles.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  return { positions: Float32Array.from(positions), triangles: Uint32Array.from(triangles) };
}

describe("colour maps", () => {
  it("are their first and last colours at 0 and 1, and hold what lies outside", () => {
    for (const map of [diverging, rising]) {
      expect(colourAt(map, 0)).toEqual([...(map[0] ?? [])]);
      expect(colourAt(map, 1)).toEqual([...(map[map.length - 1] ?? [])]);
      expect(colourAt(map, -3)).toEqual(colourAt(map, 0));
      expect(colourAt(map, 7)).toEqual(colourAt(map, 1));
      expect(colourAt(map, NaN)).toEqual(colourAt(map, 0));
    }
  });

  it("diverge from a pale middle, and rise in lightness", () => {
    const lightness = (map: typeof rising, t: number) => {
      const [r, g, b] = colourAt(map, t);
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    for (let t = 0; t < 1; t += 0.01) expect(lightness(rising, t + 0.01)).toBeGreaterThan(lightness(rising, t));
    for (let t = 0.02; t < 0.5; t += 0.01) {
      expect(lightness(diverging, t)).toBeLessThan(lightness(diverging, 0.5));
      expect(lightness(diverging, 1 - t)).toBeLessThan(lightness(diverging, 0.5));
    }
    expect(colourTable(rising, 256)).toHaveLength(1024);
  });
});

describe("frames of handles", () => {
  // The formulas of src/deform/solve/pose_matrix.cpp and HandleBuffers, written out: x = p + Σ (p, 1)-like columns · frame.
  it("take a vertex with a handle's own weights exactly to where its pose takes it", () => {
    const random = randoms(7);
    const number = () => 4 * random() - 2;
    for (let trial = 0; trial < 50; ++trial) {
      const turn = new Quaternion().setFromAxisAngle(
        new Vector3(number(), number(), number()).normalize(),
        3 * number(),
      );
      const scale = new Vector3(0.2 + random(), 1 + random(), 3 * random() + 0.1);
      const pose = new Matrix4().compose(new Vector3(number(), number(), number()).multiplyScalar(100), turn, scale);
      const centre = [100 * number(), 100 * number(), 100 * number()] as const;
      const unit = 0.5 + 50 * random();
      const frame = new Float32Array(12);
      writeFrame(pose, centre, unit, frame);
      const p = [number(), number(), number()]; // in the units of the weights
      const point = new Vector3(...(p.map((x, i) => (centre[i] ?? 0) + unit * x) as [number, number, number]));
      const expected = point.clone().applyMatrix4(pose);
      const [px = 0, py = 0, pz = 0] = p;
      const moved = [0, 1, 2].map((i) => {
        const [a = 0, b = 0, c = 0, d = 0] = frame.subarray(4 * i, 4 * i + 4);
        return (centre[i] ?? 0) + unit * ((p[i] ?? 0) + px * a + py * b + pz * c + d);
      });
      expect(expected.distanceTo(new Vector3(...(moved as [number, number, number])))).toBeLessThan(
        2e-5 * (unit + expected.length()),
      );
    }
  });

  it("are nothing for a handle at rest", () => {
    const frame = new Float32Array(24).fill(9);
    writeFrame(new Matrix4(), [5, -3, 1e6], 3, frame, 12);
    expect([...frame.subarray(12)]).toEqual(new Array(12).fill(0));
    expect([...frame.subarray(0, 12)]).toEqual(new Array(12).fill(9));
  });

  it("come from poses as edit files have them", () => {
    const matrix = [
      [1, 2, 3, 4],
      [5, 6, 7, 8],
      [9, 10, 11, 12],
      [0, 0, 0, 1],
    ] as [number[], number[], number[], number[]];
    const given = matrixOfPose({ matrix: matrix as never });
    expect(new Vector3(1, 1, 1).applyMatrix4(given ?? new Matrix4()).toArray()).toEqual([10, 26, 42]);
    const pose = {
      translate: [0, 0, 5] as [number, number, number],
      rotate: { axis: [0, 0, 2] as [number, number, number], angle_deg: 90 },
      scale: 2,
    };
    const turned = matrixOfPose(pose, [1, 0, 0]) ?? new Matrix4();
    expect(new Vector3(1, 0, 0).applyMatrix4(turned).distanceTo(new Vector3(1, 0, 5))).toBeLessThan(1e-12);
    expect(new Vector3(2, 0, 0).applyMatrix4(turned).distanceTo(new Vector3(1, 2, 5))).toBeLessThan(1e-12);
    expect(
      matrixOfPose({
        curve: [
          [0, 0, 0],
          [1, 0, 0],
        ],
      }),
    ).toBeUndefined();
  });

  it("fit into textures, or are refused", () => {
    expect(textureSize(10_000_000, 8192)).toEqual({ width: 4096, height: 2442 });
    expect(textureSize(1, 2048)).toEqual({ width: 2048, height: 1 });
    expect(textureSize(5_000_000, 2048)).toBeUndefined();
    expect(textureSize(60_000_000, 16384)).toBeUndefined();
  });
});

describe("polygons", () => {
  it("contain what lies inside, concave ones too", () => {
    const letter = new PolygonTest([
      [0, 0],
      [10, 0],
      [10, 10],
      [7, 10],
      [7, 3],
      [3, 3],
      [3, 10],
      [0, 10],
    ]); // a U
    expect(letter.contains(1.5, 8)).toBe(true);
    expect(letter.contains(5, 1)).toBe(true);
    expect(letter.contains(5, 8)).toBe(false);
    expect(letter.contains(-1, 5)).toBe(false);
    expect(new PolygonTest([]).contains(0, 0)).toBe(false);
  });

  it("share no point with their neighbours", () => {
    const random = randoms(3);
    const left = new PolygonTest([
      [0, 0],
      [0.5, 0],
      [0.3, 1],
      [0, 1],
    ]);
    const right = new PolygonTest([
      [0.5, 0],
      [1, 0],
      [1, 1],
      [0.3, 1],
    ]);
    for (let i = 0; i < 2000; ++i) {
      const [x, y] = [random(), random()];
      expect(left.contains(x, y) !== right.contains(x, y)).toBe(true);
    }
  });
});

describe("picking", () => {
  it("meets the same triangle by asking all as by a tree of boxes", () => {
    const geometry = new TorusGeometry(1, 0.4, 24, 48);
    const tree = new MeshBVH(geometry, { indirect: true });
    const random = randoms(11);
    let met = 0;
    for (let i = 0; i < 300; ++i) {
      const origin = new Vector3(6 * random() - 3, 6 * random() - 3, 6 * random() - 3);
      const direction = new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).sub(origin).normalize();
      const mine = raycastTriangles(torus.positions, torus.triangles, origin.toArray(), direction.toArray());
      const theirs = tree.raycastFirst(new Ray(origin, direction), DoubleSide);
      expect(mine === undefined).toBe(theirs === null);
      if (mine === undefined || theirs === null) continue;
      ++met;
      expect(mine.distance).toBeCloseTo(theirs.distance, 4);
    }
    expect(met).toBeGreaterThan(100);
  });
});

describe("topology", () => {
  it("has each edge once, and finds the boundary", () => {
    const box = arraysOf(new BoxGeometry()); // six squares that share no vertex
    const edges = edgesOf(box.triangles, 24);
    expect(edges.edges).toHaveLength(2 * 30);
    expect(edges.boundary).toHaveLength(2 * 24);
    const flat = sheet(20);
    const found = edgesOf(flat.triangles, 441);
    expect(found.boundary).toHaveLength(2 * 80);
    expect(found.edges).toHaveLength(2 * (2 * 20 * 21 + 400));
    expect(
      new Set(Array.from({ length: 1240 }, (_, i) => `${found.edges[2 * i]} ${found.edges[2 * i + 1]}`)).size,
    ).toBe(1240);
  });

  it("makes a coarse version on the same vertices, near the size that is asked for", () => {
    const flat = sheet(200);
    const coarse = coarseTriangles(flat.positions, flat.triangles, 2000);
    expect(coarse.length / 3).toBeGreaterThan(1000);
    expect(coarse.length / 3).toBeLessThan(4000);
    expect(coarse.every((v) => v < 201 * 201)).toBe(true);
    const box = new Box3().setFromArray(
      Array.from(coarse, (v) => [...flat.positions.subarray(3 * v, 3 * v + 3)]).flat(),
    );
    expect(box.getSize(new Vector3()).x).toBeGreaterThan(180);
  });
});

describe("normals and heat", () => {
  it("renews normals of what bears on the moved vertices, and no others", () => {
    const { positions, triangles } = sheet(10);
    const normals = new Float32Array(positions.length).fill(7);
    const part = all(NormalsOfPart.find(triangles, 121, Uint32Array.from([60])));
    expect([...part.vertices].length).toBe(7); // itself and six around it
    positions[3 * 60 + 2] = 0.5;
    all(part.update(positions, normals));
    for (const v of part.vertices) expect(Math.hypot(...normals.subarray(3 * v, 3 * v + 3))).toBeCloseTo(1, 5);
    expect(normals[0]).toBe(7);
    expect(normals[3 * 60 + 2]).toBeGreaterThan(0.5);
    expect(normals[3 * 59]).toBeLessThan(-0.05); // the normal of a slope that rises to the right points left
  });

  it("finds stretch as a power of 2, and none where nothing was stretched", () => {
    const { positions, triangles } = torus;
    for (const of of ["area", "edges"] as const) {
      const none = all(stretchOf(of, positions, positions, triangles));
      expect(Math.max(...none.map(Math.abs))).toBe(0);
      const doubled = all(
        stretchOf(
          of,
          positions,
          positions.map((x) => 2 * x),
          triangles,
        ),
      );
      for (const value of doubled) expect(value).toBeCloseTo(of === "area" ? 2 : 1, 4);
    }
  });

  it("leaves triangles without a rest shape out of the stretch", () => {
    const { positions, triangles } = torus;
    const rest = positions.slice();
    rest.fill(NaN, 0, 3);
    const moved = positions.slice();
    moved.set([9, 9, 9]);
    const stretch = all(stretchOf("area", rest, moved, triangles));
    expect(Math.max(...stretch.map(Math.abs))).toBe(0);
  });

  it("finds no detail in a flat sheet's middle, and a bump's height", () => {
    const { positions, triangles } = sheet(10);
    positions[3 * 60 + 2] = 0.5;
    const detail = all(detailOf(positions, edgesOf(triangles, 121).edges));
    expect(detail[60]).toBeCloseTo(0.5, 6);
    expect(detail[59]).toBeCloseTo(0.5 / 6, 6);
    expect(detail[24]).toBeCloseTo(0, 6);
  });

  it("measures the bend of a seam, and nothing off the seam", () => {
    // Two triangles that meet at a right angle, and a third in the plane of the second.
    const positions = Float32Array.from([0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 1, 1]);
    const triangles = Uint32Array.from([0, 2, 1, 0, 1, 3, 3, 1, 4]);
    const bends = bendsOf(positions, triangles, Uint32Array.from([0, 1]));
    [90, 90, 0, 0, 0].forEach((bend, v) => expect(bends[v]).toBeCloseTo(bend, 4));
    expect(bendsOf(positions, triangles, new Uint32Array()).every((bend) => bend === 0)).toBe(true);
  });

  it("has ranges that few extremes do not spoil", () => {
    const values = Float32Array.from({ length: 1000 }, (_, i) => (i === 0 ? 1e6 : i / 1000));
    expect(heatRange("detail", values)[1]).toBeLessThan(1);
    const [low, high] = heatRange(
      "stretch",
      values.map((x, i) => (i % 2 === 0 ? x : -x)),
    );
    expect(low).toBe(-high);
  });
});

describe("roles", () => {
  it("finds how deep in the region vertices lie", () => {
    const { positions, triangles } = sheet(20);
    const region: number[] = [];
    for (let y = 5; y <= 15; ++y) for (let x = 5; x <= 15; ++x) region.push(21 * y + x);
    const depth = all(depthInRegion(positions, triangles, Uint32Array.from(region)));
    expect(depth[region.indexOf(21 * 10 + 10)]).toBe(1);
    expect(depth[region.indexOf(21 * 5 + 10)]).toBeCloseTo(1 / 6, 1);
    const whole = Uint32Array.from({ length: 441 }, (_, v) => v);
    expect([...all(depthInRegion(positions, triangles, whole))].every((d) => d === 1)).toBe(true);
  });
});

describe("what is sent to the GPU", () => {
  it("covers all that changed", () => {
    expect(spanOfChange(Uint32Array.from([1, 5, 9]), Uint32Array.from([1, 5, 9]))).toBeUndefined();
    expect(spanOfChange(Uint32Array.from([1, 5, 9]), Uint32Array.from([1, 6, 9]))).toEqual([5, 6]);
    expect(spanOfChange(new Uint32Array(), Uint32Array.from([3, 8]))).toEqual([3, 8]);
    expect(spanOfChange(Uint32Array.from([3, 8, 20]), Uint32Array.from([8]))).toEqual([3, 20]);
  });

  it("is in a few spans", () => {
    const vertices = Uint32Array.from({ length: 3000 }, (_, i) => (i * i) % 1_000_003).sort();
    const runs = runsOf(vertices);
    expect(runs.length).toBeLessThan(40);
    for (const v of vertices) expect(runs.some(([first, last]) => first <= v && v <= last)).toBe(true);
    expect(runsOf(new Uint32Array())).toEqual([]);
  });
});

describe("navigation", () => {
  function navigation(up: "y" | "z" = "z"): Navigation {
    const one = new Navigation({
      requestRender: () => undefined,
      pointUnder: () => undefined,
      bounds: () => new Sphere(new Vector3(), 1),
      fitUnder: () => undefined,
    });
    one.upright = uprightOf(up);
    one.update(1.5);
    return one;
  }

  it("looks along what it is told to, with up upright", () => {
    for (const up of ["y", "z"] as const)
      for (const side of ["front", "back", "left", "right", "top", "bottom"] as const) {
        const one = navigation(up);
        const view = viewFrom(side, one.axes());
        one.lookAlong(view.direction, view.up, false);
        one.update(1.5);
        expect(new Vector3(0, 0, -1).applyQuaternion(one.orientation()).distanceTo(view.direction)).toBeLessThan(1e-6);
        expect(new Vector3(0, 1, 0).applyQuaternion(one.orientation()).distanceTo(view.up)).toBeLessThan(1e-6);
      }
  });

  it("keeps the point that it zooms to at the same pixel", () => {
    for (const orthographic of [false, true]) {
      const one = navigation();
      one.orthographic = orthographic;
      const point = new Vector3(0.3, -0.4, 0.6);
      const before = point.clone().project(one.camera);
      one.zoom(0.4, point);
      one.update(1.5);
      const after = point.clone().project(one.camera);
      expect(Math.hypot(after.x - before.x, after.y - before.y)).toBeLessThan(1e-5);
    }
  });

  it("frames positions so that all are in the picture, and few are far from its border", () => {
    for (const orthographic of [false, true]) {
      const one = navigation();
      one.orthographic = orthographic;
      one.fit(torus.positions, 0, false);
      one.update(1.5);
      const positions = Array.from({ length: torus.positions.length / 3 }, (_, v) =>
        new Vector3().fromArray(torus.positions, 3 * v).project(one.camera),
      );
      const most = Math.max(...positions.map((p) => Math.max(Math.abs(p.x), Math.abs(p.y))));
      expect(most).toBeLessThan(1);
      expect(most).toBeGreaterThan(0.7);
    }
  });

  it("keeps what it framed in a picture of other proportions, until the camera is moved", () => {
    const { positions } = sheet(20);
    const reach = (one: Navigation, aspect: number) => {
      one.update(aspect);
      const corners = Array.from({ length: positions.length / 3 }, (_, v) => new Vector3().fromArray(positions, 3 * v));
      return Math.max(...corners.map((p) => Math.abs(p.project(one.camera).x)));
    };
    const one = navigation();
    one.fit(positions, 0, false);
    expect(reach(one, 0.4)).toBeLessThan(1);
    const distance = one.distance;
    one.pan(1, 0);
    one.update(1.5);
    expect(one.distance).toBe(distance);
    one.fit(positions, 0, false);
    expect(one.distance).toBeLessThan(distance);
    one.lookAlong(new Vector3(0, 1, 0), undefined, false);
    const looked = one.distance;
    one.update(0.4);
    expect(one.distance).toBe(looked);
  });
});

/** An element with what the navigation uses of a canvas. */
class FakeCanvas extends EventTarget {
  readonly style = {};
  setPointerCapture(): void {}
  getBoundingClientRect() {
    return { left: 0, top: 0, width: 600, height: 400 };
  }
}

describe("navigation by fingers and wheel", () => {
  beforeAll(() => void vi.stubGlobal("HTMLCanvasElement", FakeCanvas));
  afterAll(() => void vi.unstubAllGlobals());

  function viewed() {
    const one = new Navigation({
      requestRender: () => undefined,
      pointUnder: () => undefined,
      bounds: () => new Sphere(new Vector3(), 1),
      fitUnder: () => undefined,
    });
    const canvas = new FakeCanvas();
    one.attach(canvas as unknown as HTMLElement);
    const send = (type: string, fields: object) => {
      const event = Object.assign(new Event(type, { cancelable: true }), { button: 0, ...fields });
      canvas.dispatchEvent(event);
      return event;
    };
    const touch = (type: string, pointerId: number, clientX: number, clientY = 200) =>
      send(type, { pointerId, pointerType: "touch", clientX, clientY });
    const pinch = () => {
      touch("pointerdown", 1, 200);
      touch("pointerdown", 2, 400);
      touch("pointermove", 2, 500);
      touch("pointermove", 1, 150);
    };
    return { one, send, touch, pinch, where: () => [one.distance, ...one.target.toArray(), ...one.orientation().toArray()] };
  }

  it("pinches and zooms", () => {
    const { one, send, pinch } = viewed();
    pinch();
    expect(one.isDragging).toBe(true);
    const pinched = one.distance;
    expect(pinched).toBeLessThan(5);
    send("wheel", { ctrlKey: true, deltaY: -10, deltaX: 0, deltaMode: 0, clientX: 300, clientY: 200 });
    expect(one.distance).toBeLessThan(pinched);
  });

  it("does neither while it is blocked, and forgets the fingers that came meanwhile", () => {
    const { one, send, touch, pinch, where } = viewed();
    const before = where();
    let isBlocked = true;
    one.isBlocked = () => isBlocked;
    pinch();
    for (const ctrlKey of [true, false]) {
      const event = send("wheel", { ctrlKey, deltaY: -10, deltaX: 0, deltaMode: 0, clientX: 300, clientY: 200 });
      expect(event.defaultPrevented).toBe(true); // the browser must not zoom the page either
    }
    expect(where()).toEqual(before);
    isBlocked = false;
    touch("pointermove", 2, 550);
    expect(one.isDragging).toBe(false);
    expect(where()).toEqual(before);
  });
});

describe("notes", () => {
  it("have round lengths and few digits", () => {
    expect(roundLength(73)).toBe(50);
    expect(roundLength(0.031)).toBeCloseTo(0.02, 12);
    expect(roundLength(1)).toBe(1);
    expect(lengthText(0.5, "mm")).toBe("0.5 mm");
    expect(lengthText(12.3456, "none")).toBe("12.3");
  });
});

describe("work in slices", () => {
  it("goes on until all is done, and gives up what was begun anew", async () => {
    const slices = new Slices(1);
    const log: string[] = [];
    function* work(name: string, steps: number): Generator<void, void> {
      for (let i = 0; i < steps; ++i) {
        const until = performance.now() + 0.7;
        while (performance.now() < until);
        yield;
      }
      log.push(name);
    }
    slices.start("a", work("a, given up", 20));
    slices.start("b", work("b", 5));
    slices.start("a", work("a", 3));
    while (slices.isRunning("a") || slices.isRunning("b")) await new Promise((resolve) => setTimeout(resolve, 2));
    expect(log.sort()).toEqual(["a", "b"]);
  });
});
