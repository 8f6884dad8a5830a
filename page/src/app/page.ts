import type { Viewport } from "../view/viewport";
import type { Editor } from "./editor";
import type { Rows4, Vector3Tuple } from "./graft/graft_step";
import type { Command } from "./keys";

/** What the graft panel asks of the tools. */
export interface GraftActions {
  /** A part is pressed in the panel: dragged out of it, it follows the pointer over the surface. `add` opens it. */
  dragPart(add: () => Promise<string | undefined>, press: PointerEvent): void;
  /** The next click on the surface drops it there. */
  dropByClick(add: () => Promise<string | undefined>): Promise<void>;
  /** Lays the cutting plane through the middle of a mesh, across an axis. */
  layPlane(mesh: number, axis: 0 | 1 | 2): void;
  /** How far the cutting plane is from the middle, and how far it goes at most. */
  planePlace(): { offset: number; reach: number } | undefined;
  movePlane(offset: number): void;
  /** Of a mesh's box, in its own coordinates. */
  middleOf(mesh: number): Vector3Tuple;
  /** Where the graft in work has found the part to go; null: it has not. */
  foundPose(): Rows4 | null;
}

/** What every panel gets. */
export interface Page {
  readonly editor: Editor;
  readonly viewport: Viewport;
  readonly commands: readonly Command[];
  readonly graft: GraftActions;
  /** Puts the view, and the tools on it, into an element. */
  attach(host: HTMLElement): void;
}

/** The command of this name. Throws where the table has none. */
export function commandOf(page: Page, id: string): Command {
  const found = page.commands.find((command) => command.id === id);
  if (found === undefined) throw new Error(`there is no command ${id}`);
  return found;
}
