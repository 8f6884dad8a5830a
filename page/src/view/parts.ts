import { signal } from "@preact/signals";
import { Group, Matrix4, Ray, Sphere, Vector3, type Scene } from "three";
import { raycastSurface, type Hit } from "./picking/picking";
import type { PickTree } from "./picking/pick_tree";
import type { Surface } from "./surface/surface";

/** A part and where it is shown. `matrixWorld` maps its own coordinates to the world, in the view only. */
export class Part {
  readonly group = new Group();
  /** Lines along its loops, which may be visible while the part is hidden. */
  readonly loops = new Group();

  constructor(readonly surface: Surface) {
    for (const group of [this.group, this.loops]) group.matrixAutoUpdate = false;
    this.group.add(surface.object);
  }

  get matrixWorld(): Matrix4 {
    return this.group.matrix;
  }
  set matrixWorld(to: Matrix4) {
    for (const group of [this.group, this.loops]) {
      group.matrix.copy(to);
      group.updateMatrixWorld(true);
    }
  }

  sphere(): Sphere {
    return this.surface.sphere().applyMatrix4(this.matrixWorld);
  }

  /** Intersects a world ray with the part. The hit is in world coordinates. */
  raycast(ray: Ray, tree: PickTree): (Hit & { distance: number }) | undefined {
    const inverse = this.matrixWorld.clone().invert();
    const own = new Ray(ray.origin.clone().applyMatrix4(inverse), ray.direction.clone().transformDirection(inverse));
    const hit = raycastSurface(this.surface, tree, own);
    if (hit === undefined) return undefined;
    const point = hit.point.applyMatrix4(this.matrixWorld);
    return { ...hit, point, normal: hit.normal.transformDirection(this.matrixWorld), distance: point.distanceTo(ray.origin) };
  }
}

/** The meshes beside the model, by number. */
export class Parts {
  /** Counts added parts. */
  readonly changed = signal(0);
  private readonly byMesh = new Map<number, Part>();

  constructor(
    private readonly scene: Scene,
    private readonly onRemove: (surface: Surface) => void,
  ) {}

  get(mesh: number): Part | undefined {
    return this.byMesh.get(mesh);
  }
  all(): IterableIterator<Part> {
    return this.byMesh.values();
  }
  shown(): Part[] {
    return [...this.byMesh.values()].filter((part) => part.group.visible);
  }
  of(surface: Surface): Part | undefined {
    const part = this.byMesh.get(surface.id);
    return part?.surface === surface ? part : undefined;
  }

  /** Adds a part. It is hidden until its `matrixWorld` is set. */
  add(surface: Surface): void {
    this.remove(surface.id);
    const part = new Part(surface);
    part.group.visible = false;
    this.byMesh.set(surface.id, part);
    this.scene.add(part.group, part.loops);
    ++this.changed.value;
  }

  /** Removes all parts except these. */
  keep(meshes: ReadonlySet<number>): void {
    for (const mesh of [...this.byMesh.keys()]) if (!meshes.has(mesh)) this.remove(mesh);
  }

  private remove(mesh: number): void {
    const part = this.byMesh.get(mesh);
    if (part === undefined) return;
    this.byMesh.delete(mesh);
    this.scene.remove(part.group, part.loops);
    this.onRemove(part.surface);
    part.surface.dispose();
  }
}

/** Converts a hit, a length and a camera position to the part's own coordinates. */
export function toPartCoordinates(
  part: Part,
  hit: Hit,
  radius: number,
  cameraPosition: Vector3,
): { hit: Hit; radius: number; cameraPosition: Vector3 } {
  const inverse = part.matrixWorld.clone().invert();
  const scale = Math.cbrt(Math.abs(inverse.determinant()));
  return {
    hit: { ...hit, point: hit.point.clone().applyMatrix4(inverse) },
    radius: radius * scale,
    cameraPosition: cameraPosition.clone().applyMatrix4(inverse),
  };
}
