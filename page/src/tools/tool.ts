import type { Editor } from "../app/editor";
import type { Hit } from "../view/picking/picking";
import type { Viewport } from "../view/viewport";
import type { ScreenCamera, ScreenPoint } from "./screen_camera";
import type { GraphStore } from "./graph_store";
import type { HandleControl } from "./handle_control";
import type { Preview } from "./preview";
import type { Status } from "./status";

/** The position of the pointer and the modifier keys held. */
export interface Pointer {
  readonly screenPoint: ScreenPoint;
  readonly shift: boolean;
  readonly ctrl: boolean;
  readonly alt: boolean;
  /** How hard a pen presses, 0 to 1; absent for other pointers. */
  readonly pressure?: number | undefined;
}

/** A drag that a tool handles. */
export interface Stroke {
  move(pointer: Pointer): void;
  end(pointer: Pointer): void;
  /** Undoes the effect of the stroke. */
  cancel(): void;
  /** Whether the stroke acts only at its end, so that a second finger makes it a pinch. */
  readonly isClick?: boolean;
  /** Whether a key that presses acts at once. Otherwise the next press ends the stroke. */
  readonly endsByOneKey?: boolean;
  /** Whether `move` gets every position of the pointer, and not only the last one before each picture. */
  readonly followsPath?: boolean;
}

/** Makes a stroke that acts where it ends, however the pointer moved. */
export function clickStroke(end: (pointer: Pointer) => void): Stroke {
  return { move: () => undefined, end, cancel: () => undefined, isClick: true };
}

/** The objects that a tool works with. */
export interface ToolContext {
  readonly editor: Editor;
  readonly viewport: Viewport;
  readonly camera: ScreenCamera;
  readonly graphs: GraphStore;
  readonly control: HandleControl;
  readonly status: Status;
  /** Highlights what a click would take. */
  readonly preview: Preview;
}

export interface Tool {
  /** The cursor over the model. */
  readonly cursor: string;
  /** Whether strokes may begin off the model. */
  readonly beginsOffSurface?: boolean;
  /** Called while the pointer moves without a button held, over the model or off it. */
  hover(pointer: Pointer, hit: Hit | undefined): void;
  /** Handles a press; undefined leaves it to the navigation. */
  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined;
  /** Called when the pointer leaves or another tool is chosen. Hides what the tool shows. */
  leave(): void;
  /** Ends an operation of several clicks. Returns whether there was one. */
  confirm?(): boolean;
  escape?(): boolean;
  /** Handles keys before commands do, and the wheel before the navigation does. Returns whether the tool used them. */
  takeKey?(event: KeyboardEvent): boolean;
  wheel?(event: WheelEvent): boolean;
  /** Says for those who do not see it what the tool shows at a point. */
  wordsAt?(screenPoint: ScreenPoint): string | undefined;
}

const usualPressure = 0.5;
const mostByPressure = 1.8; // × the chosen size
const leastByPressure = 0.25;

/** Returns the radius of the brush at a pointer, in pixels. A pen that presses harder paints wider. */
export function brushRadiusAt(radiusPx: number, { pressure }: Pick<Pointer, "pressure">): number {
  if (pressure === undefined) return radiusPx;
  return radiusPx * Math.min(mostByPressure, Math.max(leastByPressure, pressure / usualPressure));
}

/** Returns whether a stroke adds to the selection, removes from it, or replaces it. */
export function combineOf(context: ToolContext, { shift, ctrl, alt }: Pointer): "set" | "add" | "remove" {
  if (ctrl || alt) return "remove";
  return shift ? "add" : context.editor.tools.combine.value;
}
