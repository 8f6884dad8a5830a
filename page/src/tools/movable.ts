import type { Vector3 } from "three";
import type { GestureKind } from "./gesture";
import type { Placement } from "./pose_math";

/** The object that the gizmo is attached to. */
export interface Moved {
  readonly name: string;
  readonly placement: Placement;
  readonly defaultPivot: Vector3;
  /** Radius of what is moved around its pivot, in world units; absent: unknown. */
  readonly radius?: number | undefined;
}

/** An object that the gizmo can move: a handle, a part, a cutting plane. */
export interface Movable {
  /** Absent: the gizmo is hidden. */
  readonly active: Moved | undefined;
  /** The available kinds of gesture; absent: all. */
  readonly gestureKinds?: readonly GestureKind[] | undefined;
  /** Shows a placement while a gesture goes on. */
  show(name: string, placement: Placement): void;
  /** Commits the placement at the end of a gesture. */
  commit(name: string, placement: Placement): Promise<void>;
  /** Reverts to the placement before the gesture. */
  revert(name: string, placement: Placement): void;
}

/** Forwards to the first of several movables that is active. */
export class FirstActive implements Movable {
  constructor(private readonly all: readonly Movable[]) {}

  private get first(): Movable | undefined {
    return this.all.find(({ active }) => active !== undefined);
  }
  get active(): Moved | undefined {
    return this.first?.active;
  }
  get gestureKinds(): readonly GestureKind[] | undefined {
    return this.first?.gestureKinds;
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
