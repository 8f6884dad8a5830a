import type { ReadonlySignal } from "@preact/signals";
import type { Viewport } from "../view/viewport";
import type { Box, Editor } from "./editor";
import type { Pair, Rows4, StartCandidate, Vector3Tuple } from "./graft/graft_step";
import type { LoopRef } from "./graft/graft";
import type { PlaneTilt } from "./graft/plane_tilt";
import type { Command } from "./keys";
import type { Tour } from "./tour";

/** The functions of the tools that the graft panel uses. */
export interface GraftActions {
  /**
   * Handles a press on a part in the panel. If it is dragged out, it follows the pointer over the surface. `add` opens
   * it.
   */
  dragPart(add: () => Promise<string | undefined>, press: PointerEvent): void;
  /** Drops the part at the next click on the surface. `isByKey`: the cursor of the keyboard carries it. */
  dropByClick(add: () => Promise<string | undefined>, isByKey?: boolean): Promise<void>;
  /** Places the cutting plane through the centre of a mesh, normal to an axis. */
  setPlane(mesh: number, axis: 0 | 1 | 2): void;
  /** Returns the distance of the cutting plane from the centre, and the largest such distance. */
  planeOffset(): { offset: number; limit: number } | undefined;
  movePlane(offset: number): void;
  /** Returns how the cutting plane is tilted; undefined without one. */
  planeTilt(): PlaneTilt | undefined;
  /** Tilts the cutting plane about its point. */
  tiltPlane(tilt: PlaneTilt): void;
  /** Returns the centre of a loop's vertices, in the mesh's own coordinates. */
  loopCentre(loop: LoopRef): Vector3Tuple | undefined;
  /** Returns the centre of a mesh's box, in the mesh's own coordinates. */
  centreOf(mesh: number): Vector3Tuple;
  /** Returns the box of a mesh as it is shown, in the mesh's own coordinates; null where it is not shown. */
  boxOf(mesh: number): Box | null;
  /** Returns the pose that the current graft found for the part; null if it found none. */
  foundPose(): Rows4 | null;
  /** Returns a small picture of a rotation of a pair; undefined while the placement of the part is not known. */
  startPicture(pair: Pair, candidate: StartCandidate): Promise<string> | undefined;
}

/** The objects that every panel gets. */
export interface Page {
  readonly editor: Editor;
  readonly viewport: Viewport;
  /** The bounding box of the model as it is shown, deformed. */
  readonly shownBox: ReadonlySignal<Box | null>;
  readonly commands: readonly Command[];
  readonly graft: GraftActions;
  readonly tour: Tour;
  /** Adds the view and its tools to an element. */
  attach(host: HTMLElement): void;
}

/** Returns the command with this id. Throws if there is none. */
export function commandOf(page: Page, id: string): Command {
  const found = page.commands.find((command) => command.id === id);
  if (found === undefined) throw new Error(`there is no command ${id}`);
  return found;
}
