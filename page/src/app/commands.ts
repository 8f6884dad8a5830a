import type { Editor } from "./editor";
import type { SelectionChange } from "./graft/graft";
import type { Command } from "./keys";
import type { ToolName, ToolSettings } from "./tool_settings";
import type { ViewSettings } from "./view_settings";

/** The dialogs that commands can open. */
export interface PageActions {
  open(): void;
  save(): void;
  saveAs(): void;
  exportMesh(): void;
  help(): void;
}

/** The actions of the tools that commands can call. */
export interface ToolActions {
  /** Goes back by one step: first ends a gesture, stroke or curve, then deactivates the handle, then the tool. */
  escape(): void;
  /** Reverts the drag or the typed number in progress. Returns whether there was one. */
  cancelGesture(): boolean;
  /** Ends the operation in progress and keeps its result. */
  confirm(): void;
  /** Returns whether an operation can be confirmed. Reads signals. */
  canConfirm(): boolean;
  /** Begins to move, turn or scale the active handle with the pointer, without a button held. */
  beginGesture(kind: "move" | "turn" | "scale"): void;
  togglePivot(): void;
  resetPivot(): void;
  resetPose(): void;
  removeHandle(): void;
  handleFromSelection(): void;
  /** Makes the next handle (1) or the previous one (-1) active. */
  stepHandle(by: 1 | -1): void;
  resizeBrush(factor: number): void;
}

export type AxisView = "front" | "back" | "right" | "left" | "top" | "bottom";

/** The actions of the view that commands can call. */
export interface ViewActions {
  fit(what?: "all" | Uint32Array): void;
  /** Returns the vertices that the key F frames: those of the active handle, else the selection, else undefined. */
  inFocus(): Uint32Array | undefined;
  lookFrom(side: AxisView): void;
  toggleProjection(): void;
}

export interface CommandContext {
  readonly editor: Editor;
  readonly settings: ToolSettings;
  readonly view: ViewSettings;
  readonly tools: ToolActions;
  readonly viewport: ViewActions;
  readonly page: PageActions;
}

/** Makes the table of all commands. Buttons, menus, the keyboard and the help sheet all use this table. */
export function makeCommands(context: CommandContext): Command[] {
  return [
    ...fileCommands(context),
    ...editCommands(context),
    ...toolCommands(context),
    ...selectCommands(context),
    ...handleCommands(context),
    ...viewCommands(context),
  ];
}

function fileCommands({ editor, page }: CommandContext): Command[] {
  const isOpen = () => editor.isOpen.value;
  return [
    {
      id: "open", group: "file", label: "Open…", keys: ["ctrl+O"],
      help: "Opens a model or an edit file.",
      run: () => page.open(), enabled: () => true,
    },
    {
      id: "save", group: "file", label: "Save", keys: ["ctrl+S"],
      help: "Saves the edit: what was done, without the mesh.",
      run: () => page.save(), enabled: isOpen,
    },
    {
      id: "save-as", group: "file", label: "Save as…", keys: ["ctrl+shift+S"],
      help: "Saves the edit, or the mesh, where you say.",
      run: () => page.saveAs(), enabled: isOpen,
    },
    {
      id: "export", group: "file", label: "Export mesh…", keys: ["ctrl+E"],
      help: "Writes the deformed mesh to a file.",
      run: () => page.exportMesh(), enabled: isOpen,
    },
  ];
}

function editCommands({ editor, tools, page }: CommandContext): Command[] {
  const state = editor.state;
  const hasHandles = () => (state.value?.handles.length ?? 0) > 0;
  return [
    {
      id: "undo", group: "edit", label: "Undo", keys: ["ctrl+Z"], repeats: true,
      help: "Takes back the last change.",
      run: () => tools.cancelGesture() || void editor.undoOrRedo("undo"),
      enabled: () => (state.value?.undo ?? null) !== null,
    },
    {
      id: "redo", group: "edit", label: "Redo", keys: ["ctrl+shift+Z", "ctrl+Y"], repeats: true,
      help: "Does again what was taken back.",
      run: () => tools.cancelGesture() || void editor.undoOrRedo("redo"),
      enabled: () => (state.value?.redo ?? null) !== null,
    },
    {
      id: "accept", group: "edit", label: "Accept step", keys: ["ctrl+Enter"],
      help: "Keeps this deformation and starts the next one on its shape.",
      run: () => void (editor.graft.kept.value === undefined ? editor.ask({ do: "accept" }) : editor.graft.accept()),
      enabled: () =>
        editor.graft.kept.value === undefined ? hasHandles() : editor.graft.report.value?.error === undefined,
    },
    {
      id: "done", group: "edit", label: "Done", keys: [],
      help: "Hands the mesh back to the program that opened the editor.",
      run: () => void editor.done(), enabled: () => editor.isWaitedFor.value && editor.isOpen.value,
    },
    {
      id: "confirm", group: "edit", label: "Confirm", keys: ["Enter"],
      help: "Ends the gesture, or the curve, as it is.",
      run: () => tools.confirm(), enabled: () => tools.canConfirm(),
    },
    {
      id: "escape", group: "edit", label: "One step back", keys: ["Escape"],
      help: "Leaves the gesture as it was, then messages, then the handle, then the tool.",
      run: () => void (tools.cancelGesture() || editor.dismissMessages() || tools.escape()), enabled: () => true,
    },
    {
      id: "help", group: "help", label: "Help", keys: ["?", "F1"],
      help: "All keys, and a short tour.",
      run: () => page.help(), enabled: () => true,
    },
  ];
}

const toolTable: readonly [ToolName, string, string, string][] = [
  ["navigate", "Look around", "Q", "A drag turns the view; a click on a handle picks it up."],
  ["handle", "Handle", "H", "Paint what you want to hold; then move, turn and scale it."],
  ["vertex", "Point handle", "P", "Click a vertex to hold it."],
  ["curve", "Curve handle", "U", "Click points; the curve follows the edges between. Enter ends it."],
  ["brush", "Brush", "B", "Paint a selection. [ and ] change its size."],
  ["lasso", "Lasso", "L", "Draw around what you want to select."],
  ["box", "Box", "M", "Drag a rectangle around what you want to select."],
  ["connected", "Connected part", "C", "Click to select all that is connected."],
  ["loop", "Boundary loop", "O", "Click near a hole to select its boundary."],
  ["flood", "Flood", "W", "Click to select up to the next crease."],
];

function toolCommands({ editor, settings, tools }: CommandContext): Command[] {
  const enabled = () => editor.isOpen.value;
  return [
    ...toolTable.map(([tool, label, key, help]): Command => ({
      id: `tool-${tool}`, group: "tool", label, keys: [key], help,
      run: () => (settings.tool.value = tool), enabled, active: () => settings.tool.value === tool,
    })),
    {
      id: "brush-smaller", group: "tool", label: "Smaller brush", keys: ["["], repeats: true,
      help: "Alt and the wheel change the size, too.",
      run: () => tools.resizeBrush(1 / 1.15), enabled,
    },
    {
      id: "brush-larger", group: "tool", label: "Larger brush", keys: ["]"], repeats: true,
      help: "Alt and the wheel change the size, too.",
      run: () => tools.resizeBrush(1.15), enabled,
    },
    {
      id: "through", group: "tool", label: "Through", keys: ["T"],
      help: "Selects what lies behind and is hidden, too.",
      run: () => (settings.through.value = !settings.through.value), enabled, active: () => settings.through.value,
    },
  ];
}

function selectCommands({ editor, tools }: CommandContext): Command[] {
  const { graft } = editor;
  // In graft mode the selection is the fixed part of the source. It exists only while the fixed part is painted.
  const isOpen = () => editor.isOpen.value && (graft.mode.value !== "graft" || graft.paintsFixed.value);
  const some = () => isOpen() && editor.selected.value > 0;
  const onModel = () => some() && !graft.paintsFixed.value;
  const select = (change: SelectionChange) =>
    void (graft.paintsFixed.value ? graft.selectFixed(change) : editor.ask({ do: "select", ...change }));
  const grow = (rings: number) => select({ how: "grow", rings });
  return [
    {
      id: "select-all", group: "select", label: "Select all", keys: ["A", "ctrl+A"],
      help: "Selects every vertex.",
      run: () => select({ how: "set", what: "all" }), enabled: isOpen,
    },
    {
      id: "select-none", group: "select", label: "Select nothing", keys: ["alt+A", "shift+A"],
      help: "Selects nothing.",
      run: () => select({ how: "set", what: { indices: [] } }), enabled: some,
    },
    {
      id: "select-invert", group: "select", label: "Invert", keys: ["I", "ctrl+I"],
      help: "Selects what is not selected, and nothing else.",
      run: () => select({ how: "invert" }), enabled: isOpen,
    },
    {
      id: "select-grow", group: "select", label: "Grow", keys: ["+", "=", "ctrl++"], repeats: true,
      help: "Adds the next ring of vertices.",
      run: () => grow(1), enabled: some,
    },
    {
      id: "select-shrink", group: "select", label: "Shrink", keys: ["-", "ctrl+-"], repeats: true,
      help: "Takes the outermost ring of vertices away.",
      run: () => grow(-1), enabled: some,
    },
    {
      id: "make-handle", group: "select", label: "Make handle", keys: ["shift+H"],
      help: "Holds the selected vertices.",
      run: () => tools.handleFromSelection(), enabled: onModel,
    },
    {
      id: "make-region", group: "select", label: "Make region", keys: ["shift+E"],
      help: "Only the selected vertices may move.",
      run: () => void editor.ask({ do: "region" }), enabled: onModel,
    },
    {
      id: "make-fixed", group: "select", label: "Make fixed", keys: ["shift+X"],
      help: "The selected vertices stay where they are.",
      run: () => void editor.ask({ do: "fixed" }), enabled: onModel,
    },
  ];
}

function handleCommands({ editor, settings, tools }: CommandContext): Command[] {
  const active = () =>
    editor.state.value?.handles.some((handle) => handle.name === settings.activeHandle.value) === true;
  const isSymmetric = () => (editor.state.value?.symmetry ?? null) !== null;
  const several = () => (editor.state.value?.handles.length ?? 0) > 0;
  const gesture = (kind: "move" | "turn" | "scale", label: string, key: string): Command => ({
    id: kind, group: "handle", label, keys: [key],
    help: `${label} with the pointer; X, Y or Z keeps to an axis; type a number; Enter or a click ends.`,
    run: () => tools.beginGesture(kind), enabled: active,
  });
  return [
    gesture("move", "Move", "G"),
    gesture("turn", "Turn", "R"),
    gesture("scale", "Scale", "S"),
    {
      id: "pivot", group: "handle", label: "Move pivot", keys: ["D"],
      help: "Drag the point that turning and scaling keep.",
      run: () => tools.togglePivot(), enabled: active, active: () => settings.movesPivot.value,
    },
    {
      id: "pivot-reset", group: "handle", label: "Pivot back to the boundary", keys: ["shift+D"],
      help: "Puts the pivot to the centre of the handle's boundary.",
      run: () => tools.resetPivot(), enabled: active,
    },
    {
      id: "gizmo-space", group: "handle", label: "Local axes", keys: ["K"],
      help: "The arrows follow the handle's turn, or the world's axes.",
      run: () => (settings.gizmoSpace.value = settings.gizmoSpace.value === "local" ? "world" : "local"),
      enabled: () => editor.isOpen.value, active: () => settings.gizmoSpace.value === "local",
    },
    {
      id: "snap", group: "handle", label: "Snap", keys: ["shift+S"],
      help: "Moves, turns and scales in steps. Ctrl does so for one drag.",
      run: () => (settings.snap.value = !settings.snap.value),
      enabled: () => editor.isOpen.value, active: () => settings.snap.value,
    },
    {
      id: "reset-pose", group: "handle", label: "Put handle back", keys: ["alt+G"],
      help: "The handle goes back to where the step found it.",
      run: () => tools.resetPose(), enabled: active,
    },
    {
      id: "symmetry", group: "handle", label: "Symmetry", keys: ["Y"],
      help: "What is done on one side of a plane is done on the other, too.",
      run: () => void editor.setSymmetry(!isSymmetric()),
      enabled: () => editor.isOpen.value, active: isSymmetric,
    },
    {
      id: "remove-handle", group: "handle", label: "Remove handle", keys: ["Delete", "Backspace"],
      help: "Lets go of these vertices.",
      run: () => tools.removeHandle(), enabled: active,
    },
    {
      id: "next-handle", group: "handle", label: "Next handle", keys: ["N"],
      help: "The next handle becomes the active one.",
      run: () => tools.stepHandle(1), enabled: several,
    },
    {
      id: "previous-handle", group: "handle", label: "Handle before", keys: ["shift+N"],
      help: "The handle before becomes the active one.",
      run: () => tools.stepHandle(-1), enabled: several,
    },
  ];
}

const sides: readonly [AxisView, string, string][] = [
  ["front", "From the front", "Num1"],
  ["back", "From behind", "ctrl+Num1"],
  ["right", "From the right", "Num3"],
  ["left", "From the left", "ctrl+Num3"],
  ["top", "From above", "Num7"],
  ["bottom", "From below", "ctrl+Num7"],
];

function viewCommands({ editor, view, viewport }: CommandContext): Command[] {
  const enabled = () => editor.isOpen.value;
  return [
    {
      id: "before", group: "view", label: "Before", keys: ["\\", "`"],
      help: "Shows the mesh as the step found it, while the key is down.",
      run: () => (view.before.value = true), release: () => (view.before.value = false),
      enabled, active: () => view.before.value,
    },
    {
      id: "fit", group: "view", label: "Fit", keys: ["F", "Num."],
      help: "Frames the handle, the selection or everything.",
      run: () => viewport.fit(viewport.inFocus() ?? "all"), enabled,
    },
    {
      id: "fit-all", group: "view", label: "Fit all", keys: ["Home", "shift+F"],
      help: "Frames everything.",
      run: () => viewport.fit("all"), enabled,
    },
    ...sides.map(([side, label, key]): Command => ({
      id: `look-${side}`, group: "view", label, keys: [key], help: `Looks at the model ${label.toLowerCase()}.`,
      run: () => viewport.lookFrom(side), enabled,
    })),
    {
      id: "projection", group: "view", label: "Parallel projection", keys: ["Num5", "5"],
      help: "With perspective, or without.",
      run: () => viewport.toggleProjection(), enabled,
    },
    {
      id: "wireframe", group: "view", label: "Wireframe", keys: ["Z"],
      help: "Draws the edges of the mesh.",
      run: () => (view.wireframe.value = !view.wireframe.value), enabled, active: () => view.wireframe.value,
    },
  ];
}
