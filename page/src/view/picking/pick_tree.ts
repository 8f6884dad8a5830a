import { Box3, BufferAttribute, BufferGeometry, DoubleSide, Ray, Sphere, Vector3 } from "three";
import { MeshBVH } from "three-mesh-bvh";
import { MeshWork, type FromWorker } from "../surface/mesh_work";
import { raycastTriangles, type RayHit } from "./ray";
import type { Surface } from "../surface/surface";

const refittedHere = 200_000; // triangles up to which the page itself refits the tree, in some milliseconds
const isLarge = 300_000; // triangles above which a coarse version is made

/**
 * Intersects rays and balls with a surface as shown. A worker builds the bounding-volume tree. Until the tree exists
 * and is up to date with a deformation, every triangle is tested.
 */
export class PickTree {
  private readonly geometry = new BufferGeometry();
  private readonly work: MeshWork;
  private tree: MeshBVH | undefined;
  private version = -1; // version of the surface that the tree is built for
  private asked = -1;

  constructor(private readonly surface: Surface) {
    const { positions, triangles, version } = surface;
    this.geometry.setIndex(new BufferAttribute(triangles, 1));
    const coarse = surface.triangleCount > isLarge ? 120_000 : 0;
    this.asked = version;
    this.work = new MeshWork((answer) => this.onAnswer(answer));
    surface.slices.start("tree", this.work.begin(positions, triangles, version, coarse));
  }

  /** Whether the tree exists and is up to date. */
  get isReady(): boolean {
    return this.tree !== undefined && this.version === this.surface.version;
  }

  /** Intersects a ray, given in the surface's coordinates (relative to its offset). */
  raycast(origin: Vector3, direction: Vector3): RayHit | undefined {
    const tree = this.current();
    if (tree === undefined) {
      const { positions, triangles } = this.surface;
      return raycastTriangles(
        positions,
        triangles,
        [origin.x, origin.y, origin.z],
        [direction.x, direction.y, direction.z],
      );
    }
    const hit = tree.raycastFirst(new Ray(origin, direction), DoubleSide);
    const face = hit?.faceIndex;
    return hit === null || face === undefined || face === null ? undefined : { face, distance: hit.distance };
  }

  /** Calls `found` for each triangle with a corner in the ball, once each. */
  facesNear(centre: Vector3, radius: number, found: (face: number) => void): void {
    const { positions, triangles } = this.surface;
    const check = (face: number) => {
      for (let k = 0; k < 3; ++k)
        if (isNear(positions, triangles[3 * face + k] as number, centre, radius * radius)) return found(face);
    };
    const tree = this.current();
    if (tree === undefined) {
      for (let face = 0; 3 * face < triangles.length; ++face) check(face);
      return;
    }
    const ball = new Sphere(centre, radius);
    tree.shapecast({
      intersectsBounds: (box: Box3) => box.intersectsSphere(ball),
      intersectsTriangle: (_triangle, face: number) => {
        check(face);
        return false;
      },
    });
  }

  /** Brings the tree up to date now, however long it takes. Returns false if there is no tree yet. */
  prepare(): boolean {
    if (this.tree === undefined) return false;
    if (!this.isReady) this.refitHere(this.tree);
    return true;
  }

  dispose(): void {
    this.work.dispose();
    this.geometry.dispose();
  }

  private current(): MeshBVH | undefined {
    const { surface, tree } = this;
    if (tree === undefined || this.isReady) return tree;
    if (surface.triangleCount <= refittedHere) return this.refitHere(tree);
    if (this.asked !== surface.version && !surface.slices.isRunning("tree")) this.askForRefit();
    return undefined;
  }

  private askForRefit(): void {
    const { surface } = this;
    this.asked = surface.version;
    const version = this.asked; // if the surface changes while arrays are sent, the answer gets version -1
    const sent = () => (version === surface.version ? version : -1);
    surface.slices.start("tree", this.work.refit(surface.positions, sent));
  }

  private refitHere(tree: MeshBVH): MeshBVH {
    this.usePositions();
    tree.refit();
    this.version = this.surface.version;
    return tree;
  }

  private usePositions(): void {
    this.geometry.setAttribute("position", new BufferAttribute(this.surface.positions, 3));
  }

  private onAnswer(answer: FromWorker): void {
    if (answer.what === "coarse") this.surface.setCoarse(answer.triangles);
    if (answer.what === "edges") this.surface.setEdges(answer.edges, answer.boundary);
    if (answer.what !== "tree") return;
    this.usePositions();
    const serialised = { version: 1, roots: answer.roots, index: null, indirectBuffer: answer.order };
    this.tree = MeshBVH.deserialize(serialised as Parameters<typeof MeshBVH.deserialize>[0], this.geometry, {
      setIndex: false,
    });
    this.version = answer.version;
  }
}

export function isNear(positions: Float32Array, v: number, centre: Vector3, radiusSquared: number): boolean {
  const x = (positions[3 * v] as number) - centre.x;
  const y = (positions[3 * v + 1] as number) - centre.y;
  const z = (positions[3 * v + 2] as number) - centre.z;
  return x * x + y * y + z * z <= radiusSquared;
}
