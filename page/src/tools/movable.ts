import type { Vector3 } from "three";
import type { Act } from "./gesture";
import type { Placement } from "./pose_math";

/** What the gizmo is at. */
export interface Moved {
  readonly name: string;
  readonly placement: Placement;
  readonly defaultPivot: Vector3;
}

/** Something that the gizmo moves: a handle, a part, a cutting plane. */
export interface Movable {
  /** Absent: the gizmo is not shown. */
  readonly active: Moved | undefined;
  /** What can be done with it; absent: all. */
  readonly acts?: readonly Act[] | undefined;
  /** While a gesture goes on. */
  show(name: string, placement: Placement): void;
  /** Its end. */
  commit(name: string, placement: Placement): Promise<void>;
  /** As it was before. */
  revert(name: string, placement: Placement): void;
}

/** The first of several that is active. */
export class FirstActive implements Movable {
  constructor(private readonly all: readonly Movable[]) {}

  private get first(): Movable | undefined {
    return this.all.find(({ active }) => active !== undefined);
  }
  get active(): Moved | undefined {
    return this.first?.active;
  }
  get acts(): readonly Act[] | undefined {
    return this.first?.acts;
  }
  show(name: string, placement: Placement): void {
    this.first?.show(name, placement);
  }
  async commit(name: string, placement: Placement): Promise<void> {
    await this.first?.commit(name, placement);
  }
  revert(name: string, placement: Placement): void {
    this.first?.revert(name, placement);
  }
}
