import type { Editor } from "../app/editor";
import type { Hit } from "../view/picking/picking";
import type { Viewport } from "../view/viewport";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import type { GraphStore } from "./graph_store";
import type { HandleControl } from "./handle_control";
import type { Preview } from "./preview";
import type { Status } from "./status";

/** Where the pointer is, and what is held with it. */
export interface Pointer {
  readonly screenPoint: ScreenPoint;
  readonly shift: boolean;
  readonly ctrl: boolean;
  readonly alt: boolean;
}

/** A drag that a tool has taken. */
export interface Stroke {
  move(pointer: Pointer): void;
  end(pointer: Pointer): void;
  /** As if it had not begun. */
  cancel(): void;
}

/** What a tool works with. */
export interface ToolContext {
  readonly editor: Editor;
  readonly viewport: Viewport;
  readonly camera: ScreenCamera;
  readonly graphs: GraphStore;
  readonly control: HandleControl;
  readonly status: Status;
  /** What a click would take. */
  readonly preview: Preview;
}

export interface Tool {
  /** Of the pointer over the model. */
  readonly cursor: string;
  /** Its strokes may begin beside the model, too. */
  readonly beginsBeside?: boolean;
  /** The pointer is over the model, or beside it, without a button. */
  hover(pointer: Pointer, hit: Hit | undefined): void;
  /** A press; undefined leaves it to the navigation. */
  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined;
  /** The pointer has left, or another tool is taken: what was shown goes. */
  leave(): void;
  /** Ends what takes several clicks; returns whether there was something. */
  confirm?(): boolean;
  escape?(): boolean;
  /** Sees keys before commands do, and the wheel before the navigation; returns whether it took them. */
  takeKey?(event: KeyboardEvent): boolean;
  wheel?(event: WheelEvent): boolean;
}

/** Whether what is taken is added to the selection, taken from it, or becomes it. */
export function combineOf(context: ToolContext, { shift, ctrl, alt }: Pointer): "set" | "add" | "remove" {
  if (ctrl || alt) return "remove";
  return shift ? "add" : context.editor.tools.combine.value;
}
