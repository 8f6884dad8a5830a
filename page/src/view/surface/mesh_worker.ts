import { BufferAttribute, BufferGeometry } from "three";
import { MeshBVH } from "three-mesh-bvh";
import { coarseTriangles, edgesOf } from "./mesh_topology";
import type { FromWorker, ToWorker } from "./mesh_work";

// Computes for a large mesh, outside the main thread: its bounding-volume tree, its edges, and a coarse version.

let positions: Float32Array<ArrayBuffer> = new Float32Array();
let triangles: Uint32Array<ArrayBuffer> = new Uint32Array();
let geometry: BufferGeometry | undefined;
let tree: MeshBVH | undefined;

function send(message: FromWorker, transfer: Transferable[]): void {
  self.postMessage(message, { transfer });
}

function sendTree(version: number): void {
  if (tree === undefined) return;
  const { roots, indirectBuffer } = MeshBVH.serialize(tree, { cloneBuffers: true });
  const buffers: Transferable[] = [...roots];
  if (indirectBuffer) buffers.push(indirectBuffer.buffer);
  send({ what: "tree", version, roots, order: indirectBuffer }, buffers);
}

function begin(version: number, coarse: number): void {
  if (coarse > 0) {
    const few = coarseTriangles(positions, triangles, coarse);
    send({ what: "coarse", triangles: few }, [few.buffer]);
  }
  geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  tree = new MeshBVH(geometry, { indirect: true, targetLeafSize: 12 });
  sendTree(version);
  const { edges, boundary } = edgesOf(triangles, positions.length / 3);
  send({ what: "edges", edges, boundary }, [edges.buffer, boundary.buffer]);
}

function take({ of, at, length, values }: Extract<ToWorker, { what: "part" }>): void {
  if (of === "positions") {
    if (positions.length !== length) positions = new Float32Array(length);
    positions.set(values, at);
  } else {
    if (triangles.length !== length) triangles = new Uint32Array(length);
    triangles.set(values, at);
  }
}

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if (data.what === "part") take(data);
  else if (data.what === "begin") begin(data.version, data.coarse);
  else {
    tree?.refit();
    sendTree(data.version);
  }
};
