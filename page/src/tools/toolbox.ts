import { effect, untracked } from "@preact/signals";
import type { ToolActions } from "../app/commands";
import type { Editor } from "../app/editor";
import type { GraftTool } from "../app/graft/graft";
import type { ToolName } from "../app/tool_settings";
import type { Hit } from "../view/picking/picking";
import type { Viewport } from "../view/viewport";
import { screenCameraOf, type ScreenPoint } from "./screen_camera";
import type { GraftView } from "../view/graft/graft_view";
import { BaseGrip } from "./graft/base_grip";
import { CutCurveTool } from "./graft/cut_curve_tool";
import { DropTool } from "./graft/drop_tool";
import { FixedTool } from "./graft/fixed_tool";
import { Gizmo } from "./gizmo";
import { cursorAction, KeyCursor, type CursorAction } from "./key_cursor";
import { GraftPanelActions } from "./graft/panel_actions";
import { LoopPairTool } from "./graft/graft_loops";
import { GraphStore } from "./graph_store";
import { CurveTool, NavigateTool, PaintTool, VertexTool } from "./handle_tools";
import { HandleControl } from "./handle_control";
import { HandleGhost } from "./handle_ghost";
import { FirstActive } from "./movable";
import { PartControl } from "./graft/part_control";
import { CutPlaneTool, PlaneControl } from "./graft/plane_control";
import { LayFlatTool, MeasureTool } from "./place_tools";
import { PlaneView } from "./graft/plane_view";
import { Preview } from "./preview";
import { ReachKnob } from "./reach_knob";
import { BrushTool, ConnectedTool, FloodTool, LoopTool, OutlineTool } from "./select_tools";
import { Status } from "./status";
import { SymmetryPlane } from "./symmetry_plane";
import type { ToolContext, Pointer, Stroke, Tool } from "./tool";
import "./tools.css";

const keyPointer = -1; // stands for the keyboard among the ids of pointers
const keyTolerance = 1.5; // of the gizmo's grips, × that of the mouse
const cursorHelp =
  "Arrow keys move a cursor over the model, with Shift farther and with Alt less far. Space clicks; with a brush or on a grip it begins a stroke, and the next Space ends it. Ctrl and arrow keys orbit. Page Up and Page Down zoom.";

/** Passes the pointer to the gizmo, to the active tool, or to the navigation. */
export class ToolBox implements ToolActions {
  readonly control: HandleControl;
  private readonly context: ToolContext;
  private readonly gizmo: Gizmo;
  private readonly reach: ReachKnob;
  private readonly base: BaseGrip;
  private readonly tools: Record<ToolName, Tool>;
  private readonly graftTools: Record<GraftTool, Tool>;
  readonly graft: GraftPanelActions;
  private tool: Tool;
  private stroke: Stroke | undefined;
  private draggingPointer: number | undefined; // id of the dragging pointer
  private pointer: Pointer = { screenPoint: { x: 0, y: 0 }, shift: false, ctrl: false, alt: false };
  private readonly cursor: KeyCursor;
  private waiting: PointerEvent[] = []; // moves until the next frame: all of a path, or else the last one

  constructor(
    private readonly editor: Editor,
    private readonly viewport: Viewport,
    graftView: GraftView,
  ) {
    const graphs = new GraphStore();
    this.control = new HandleControl(editor, viewport, graphs);
    const camera = screenCameraOf(viewport);
    const status = new Status(viewport.overlay);
    const preview = new Preview(viewport, graphs, 0xffa02e, 0.55);
    this.context = { editor, viewport, camera, graphs, control: this.control, status, preview };
    const part = new PartControl(viewport, editor.graft);
    const plane = new PlaneControl(viewport, editor.graft, graftView);
    this.gizmo = new Gizmo(editor, viewport, new FirstActive([plane, part, this.control]), camera, status);
    const drop = new DropTool(this.context, graftView);
    this.graft = new GraftPanelActions(editor, viewport, drop, (at) => this.focusCursor(at));
    new PlaneView(viewport, plane, editor.graft);
    this.cursor = new KeyCursor(viewport.overlay);
    this.graftTools = {
      loops: new LoopPairTool(this.context, graftView),
      plane: new CutPlaneTool(this.context, plane),
      stroke: new CutCurveTool(this.context, graftView),
      fixed: new FixedTool(this.context),
      drop,
    };
    this.reach = new ReachKnob(this.context, new Preview(viewport, graphs, 0x6fb4dc, 0.45), () => this.gizmo.isActive, this.gizmo);
    this.base = new BaseGrip(this.context, graftView);
    this.gizmo.otherGrips = () => [...this.reach.grips, ...this.base.grips];
    new HandleGhost(viewport, this.control, new Preview(viewport, graphs, 0xffa02e, 0.3), () => this.gizmo.isActive);
    new SymmetryPlane(viewport, this.control);
    this.tools = this.makeTools();
    this.tool = this.tools.navigate;
  }

  /** Listens to the pointer events of the canvas. The view must be attached. */
  attach(): void {
    const { canvas } = this.viewport;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.follow(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", (event) => this.lose(event));
    canvas.addEventListener("lostpointercapture", (event) => this.lose(event));
    canvas.addEventListener("pointerleave", () => this.leave());
    this.attachCursor(canvas);
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("dblclick", (event) => this.tool.confirm?.() === true && event.preventDefault());
    this.viewport.navigation.isBlocked = () => this.stroke !== undefined && this.stroke.isClick !== true;
    effect(() => {
      const { mode, tool } = this.editor.graft;
      const next = mode.value === "graft" ? this.graftTools[tool.value] : this.tools[this.editor.toolInUse.value];
      untracked(() => this.activate(next));
    });
    effect(() => {
      if (this.editor.graft.mode.value === "graft") this.editor.tools.activeHandle.value = null;
    });
    effect(() => this.prepare());
    effect(() => {
      const { gizmoSpace, movesPivot, activeHandle, brushRadiusPx } = this.editor.tools;
      void [gizmoSpace.value, movesPivot.value, activeHandle.value, brushRadiusPx.value];
      this.viewport.requestRender();
    });
  }

  /** Handles keys that a gesture takes before commands do: axes, numbers. */
  takeKey(event: KeyboardEvent): boolean {
    return this.gizmo.takeKey(event) || this.tool.takeKey?.(event) === true || this.takeCursorKey(event);
  }

  escape(): void {
    const { tools } = this.editor;
    if (this.cancelGesture()) return;
    if (this.tool.escape?.() === true) return;
    if (tools.movesPivot.value) tools.movesPivot.value = false;
    else if (tools.activeHandle.value !== null) this.control.activate(null);
    else tools.tool.value = "navigate";
  }
  cancelGesture(): boolean {
    const isActive = this.gizmo.isActive || this.stroke !== undefined;
    if (isActive) this.cancel();
    return isActive;
  }
  confirm(): void {
    if (this.gizmo.isActive) this.finishGesture();
    else this.tool.confirm?.();
  }
  canConfirm(): boolean {
    return this.gizmo.isActive || this.tool.confirm !== undefined;
  }
  beginGesture(kind: "move" | "turn" | "scale"): void {
    leaveFocus(); // Enter ends the gesture
    this.gizmo.beginModal(kind, this.pointer.screenPoint);
  }
  togglePivot(): void {
    const { movesPivot } = this.editor.tools;
    movesPivot.value = !movesPivot.value;
  }
  resetPivot(): void {
    this.gizmo.resetPivot();
  }
  resetPose(): void {
    this.control.resetPose();
  }
  removeHandle(): void {
    this.control.remove();
  }
  handleFromSelection(): void {
    void this.control.addSelected();
  }
  stepHandle(by: 1 | -1): void {
    const { names } = this.control;
    const at = names.indexOf(this.editor.tools.activeHandle.value ?? "");
    const next = at < 0 ? (by > 0 ? 0 : names.length - 1) : (at + by + names.length) % names.length;
    this.control.activate(names[next] ?? null);
  }
  resizeBrush(factor: number): void {
    const { brushRadiusPx } = this.editor.tools;
    brushRadiusPx.value = Math.round(10 * Math.min(300, Math.max(3, brushRadiusPx.value * factor))) / 10;
    this.tool.hover(this.pointer, undefined);
  }

  /** Lets the keyboard reach the view once a model is open. */
  private attachCursor(canvas: HTMLCanvasElement): void {
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "View of the model");
    canvas.setAttribute("aria-description", cursorHelp);
    this.viewport.overlay.ariaHidden = "true";
    effect(() => void (canvas.tabIndex = this.editor.isOpen.value ? 0 : -1));
    canvas.addEventListener("blur", () => {
      if (this.draggingPointer === keyPointer) this.cancel();
      this.cursor.hide();
    });
    canvas.addEventListener("pointermove", () => this.draggingPointer !== keyPointer && this.cursor.hide());
  }

  private takeCursorKey(event: KeyboardEvent): boolean {
    const { viewport } = this;
    const action = document.activeElement === viewport.canvas ? cursorAction(event) : undefined;
    if (action === undefined || (this.draggingPointer !== undefined && this.draggingPointer !== keyPointer)) return false;
    this.act(action);
    return true;
  }

  private act(action: CursorAction): void {
    const { navigation } = this.viewport;
    switch (action.kind) {
      case "orbit":
        return navigation.orbit(-0.01 * action.dx, 0.01 * action.dy);
      case "zoom":
        return navigation.zoom(action.factor, navigation.target.clone());
      case "move":
        return this.moveCursor(action.dx, action.dy);
      case "press":
        if (this.cursor.position === undefined) this.moveCursor(0, 0);
        else this.pressCursor();
    }
  }

  private moveCursor(dx: number, dy: number): void {
    this.placeCursor(dx, dy);
    this.editor.announce(this.wordsUnder(this.pointer.screenPoint));
  }

  /** Moves the focus into the view, with the cursor at a point. */
  private focusCursor(at: ScreenPoint): void {
    this.viewport.canvas.focus();
    this.cursor.hide();
    this.pointer = { ...this.pointer, screenPoint: at };
    this.placeCursor(0, 0);
  }

  private placeCursor(dx: number, dy: number): void {
    const screenPoint = this.cursor.move(dx, dy, this.pointer.screenPoint);
    // Shift and alt change the length of a step, and not how a stroke selects.
    this.pointer = { screenPoint, shift: false, ctrl: false, alt: false };
    if (this.gizmo.isModal) this.gizmo.follow(screenPoint, false);
    else if (this.stroke !== undefined) this.stroke.move(this.pointer);
    else this.hover();
  }

  /** Clicks at the cursor, or begins a stroke there, which the next press ends. */
  private pressCursor(): void {
    if (this.gizmo.isModal) return this.finishGesture();
    if (this.stroke !== undefined) {
      this.takeStroke()?.end(this.pointer);
      return this.editor.announce("The stroke ends.");
    }
    const stroke = this.strokeFor(keyTolerance);
    if (stroke === undefined) return this.editor.announce("There is nothing to press here.");
    if (stroke.isClick === true || stroke.endsByOneKey === true) return stroke.end(this.pointer);
    this.stroke = stroke;
    this.draggingPointer = keyPointer;
    this.editor.announce("The stroke begins. Space ends it, Escape cancels it.");
  }

  /** Says what is under the cursor. */
  private wordsUnder(screenPoint: ScreenPoint): string {
    const grip = this.gizmo.wordsAt(screenPoint) ?? this.base.wordsAt(screenPoint);
    if (grip !== undefined) return grip;
    const ofTool = this.tool.wordsAt?.(screenPoint);
    if (ofTool !== undefined) return ofTool;
    const hit = this.hitUnder(screenPoint);
    if (hit === undefined) return "Beside the model.";
    const handle = this.control.handleAt(hit.surface, hit.vertex);
    const said = this.context.status.words;
    if (said !== "") return `${said}.`;
    return handle === undefined ? `On the model, vertex ${hit.vertex}.` : `On ${handle}.`;
  }

  private makeTools(): Record<ToolName, Tool> {
    const { context } = this;
    return {
      navigate: new NavigateTool(context),
      handle: new PaintTool(context),
      vertex: new VertexTool(context),
      curve: new CurveTool(context),
      brush: new BrushTool(context),
      lasso: new OutlineTool(context, false),
      box: new OutlineTool(context, true),
      connected: new ConnectedTool(context),
      loop: new LoopTool(context),
      flood: new FloodTool(context),
      measure: new MeasureTool(context),
      flat: new LayFlatTool(context),
    };
  }

  private activate(tool: Tool): void {
    this.cancel();
    if (tool !== this.tool) this.tool.escape?.();
    this.tool.leave();
    this.tool = tool;
    this.viewport.canvas.style.cursor = this.tool.cursor;
  }

  // Begins to make the graph that tools need later, as soon as there is a model.
  private prepare(): void {
    void this.editor.state.value?.model.mesh;
    const { main } = this.viewport;
    if (main !== undefined) this.context.graphs.of(main);
  }

  private leave(): void {
    if (this.stroke !== undefined || this.gizmo.isActive) return;
    this.tool.leave();
    this.gizmo.leave();
  }

  // A second pointer neither moves nor ends the drag of the first one.
  private isOfOther(event: PointerEvent): boolean {
    return this.draggingPointer !== undefined && event.pointerId !== this.draggingPointer;
  }

  // The navigation, which sees the press next, begins a pinch unless the drag goes on.
  private pressAlso(): void {
    if (this.stroke?.isClick === true) this.cancel();
  }

  private press(event: PointerEvent): void {
    if (this.isOfOther(event)) return this.pressAlso();
    if (this.viewport.navigation.isDragging) return;
    this.pointer = pointerOf(event);
    if (this.gizmo.isModal) {
      event.preventDefault();
      if (event.button === 0) this.finishGesture();
      else this.cancel();
      return;
    }
    if (event.button !== 0 || this.draggingPointer !== undefined || this.viewport.settings.before.value) return;
    const stroke = this.strokeFor(event.pointerType === "mouse" ? 1 : 2);
    if (stroke === undefined) return;
    event.preventDefault(); // the navigation ignores the event
    this.waiting = []; // perhaps of another pointer
    leaveFocus();
    this.stroke = stroke;
    this.draggingPointer = event.pointerId;
    this.viewport.canvas.setPointerCapture(event.pointerId);
    window.addEventListener("wheel", keepPageScale, { passive: false });
  }

  /** Returns the drag in progress, which then belongs to the caller. */
  private takeStroke(): Stroke | undefined {
    const { stroke } = this;
    this.stroke = this.draggingPointer = undefined;
    window.removeEventListener("wheel", keepPageScale);
    return stroke;
  }

  private strokeFor(toleranceFactor: number): Stroke | undefined {
    const { pointer } = this;
    if (this.gizmo.press(pointer.screenPoint, toleranceFactor)) {
      this.tool.leave();
      return {
        move: (at) => this.gizmo.follow(at.screenPoint, at.ctrl),
        end: () => this.gizmo.end(),
        cancel: () => this.gizmo.cancel(),
      };
    }
    if (this.reach.hover(pointer.screenPoint, toleranceFactor)) return this.reach.press(pointer);
    if (this.base.hover(pointer.screenPoint, toleranceFactor)) return this.base.press(pointer);
    return this.tool.press(pointer, this.hitUnder(pointer.screenPoint));
  }

  private follow(event: PointerEvent): void {
    if (this.isOfOther(event)) return;
    const isFirst = this.waiting.length === 0;
    if (this.stroke?.followsPath === true) this.waiting.push(...positionsIn(event));
    else this.waiting = [event];
    if (isFirst) requestAnimationFrame(() => this.followNow());
  }

  private followNow(): void {
    const events = this.waiting;
    this.waiting = [];
    const event = events.at(-1);
    if (event === undefined) return;
    this.pointer = pointerOf(event);
    if (this.gizmo.isModal) this.gizmo.follow(this.pointer.screenPoint, this.pointer.ctrl);
    else if (this.stroke !== undefined) for (const each of events) this.stroke?.move(pointerOf(each));
    else if (event.buttons === 0) this.hover();
  }

  private hover(): void {
    const { screenPoint } = this.pointer;
    const { canvas } = this.viewport;
    if (this.gizmo.hover(screenPoint) || this.reach.hover(screenPoint) || this.base.hover(screenPoint)) {
      this.tool.leave();
      canvas.style.cursor = "pointer";
      return;
    }
    const hit = this.hitUnder(screenPoint);
    canvas.style.cursor = hit === undefined && this.tool.beginsOffSurface !== true ? "default" : this.tool.cursor;
    this.tool.hover(this.pointer, hit);
  }

  private release(event: PointerEvent): void {
    if (event.pointerId !== this.draggingPointer) return;
    this.followNow();
    this.pointer = pointerOf(event);
    const stroke = this.takeStroke();
    if (this.gizmo.isActive) this.gizmo.follow(this.pointer.screenPoint, this.pointer.ctrl);
    stroke?.end(this.pointer);
  }

  private lose(event: PointerEvent): void {
    if (event.pointerId === this.draggingPointer) this.cancel();
  }

  private finishGesture(): void {
    this.takeStroke();
    this.gizmo.end();
  }

  private cancel(): void {
    const stroke = this.takeStroke();
    if (stroke !== undefined) stroke.cancel();
    else this.gizmo.cancel();
  }

  private wheel(event: WheelEvent): void {
    if (this.tool.wheel?.(event) === true) {
      event.preventDefault();
      event.stopPropagation();
      return;
    }
    if (!event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.pointer = pointerOf(event);
    this.resizeBrush(Math.exp(-0.0015 * (event.deltaY || event.deltaX)));
  }

  private hitUnder({ x, y }: ScreenPoint): Hit | undefined {
    return this.viewport.pick(x, y);
  }
}

/** Takes the focus from the element that has it, which would use keys that are meant for the view. */
function leaveFocus(): void {
  const { activeElement: active } = document;
  if (active instanceof HTMLElement && !(active instanceof HTMLCanvasElement)) active.blur(); // the view takes keys
}

/** Keeps a pinch from scaling the page, which the browser would do beside the view. */
function keepPageScale(event: WheelEvent): void {
  if (event.ctrlKey) event.preventDefault();
}

/** Returns the events that the browser has joined into one since its last picture, which insecure pages do not get. */
function positionsIn(event: PointerEvent): PointerEvent[] {
  const joined = event.getCoalescedEvents?.() ?? [];
  return joined.length > 0 ? joined : [event];
}

function pointerOf(event: MouseEvent): Pointer {
  return {
    screenPoint: { x: event.clientX, y: event.clientY },
    shift: event.shiftKey,
    ctrl: event.ctrlKey || event.metaKey,
    alt: event.altKey,
    pressure: event instanceof PointerEvent && event.pointerType === "pen" && event.buttons !== 0 ? event.pressure : undefined,
  };
}
