import { partToMirror } from "./graft/mirror_latest";
import type { Editor } from "./editor";
import type { SelectionChange } from "./graft/graft";
import type { Command } from "./keys";
import { changingTools, type ToolName, type ToolSettings } from "./tool_settings";
import type { ViewSettings } from "./view_settings";

/** The dialogs that commands can open. */
export interface PageActions {
  open(): void;
  save(): void;
  saveAs(): void;
  exportMesh(): void;
  help(): void;
  tour(): void;
  /** Ends the tour. Returns whether it was shown. */
  skipTour(): boolean;
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
      help: "Saves your steps as an edit file, without the mesh.",
      run: () => page.save(), enabled: isOpen,
    },
    {
      id: "save-as", group: "file", label: "Save as…", keys: ["ctrl+shift+S"],
      help: "Saves your steps under another name or in another folder.",
      run: () => page.saveAs(), enabled: isOpen,
    },
    {
      id: "export", group: "file", label: "Export mesh…", keys: ["ctrl+E"],
      help: "Writes the edited mesh to a file.",
      run: () => page.exportMesh(), enabled: isOpen,
    },
    {
      id: "save-part", group: "file", label: "Save as a part", keys: [],
      help: "Writes the model as it is shown to the folder of the part library.",
      run: () => void editor.folders.saveAsPart(editor.state.value?.model.name ?? "part"),
      enabled: () => isOpen() && !editor.graft.isEdited.value,
    },
  ];
}

function editCommands({ editor, tools, page }: CommandContext): Command[] {
  const state = editor.state;
  const hasHandles = () => (state.value?.handles.length ?? 0) > 0;
  return [
    {
      id: "undo", group: "edit", label: "Undo", keys: ["ctrl+Z"], repeats: true,
      help: "Undoes the last change.",
      run: () => tools.cancelGesture() || void editor.undoOrRedo("undo"),
      enabled: () => (state.value?.undo ?? null) !== null,
    },
    {
      id: "redo", group: "edit", label: "Redo", keys: ["ctrl+shift+Z", "ctrl+Y"], repeats: true,
      help: "Redoes the change that was undone.",
      run: () => tools.cancelGesture() || void editor.undoOrRedo("redo"),
      enabled: () => (state.value?.redo ?? null) !== null,
    },
    {
      id: "accept", group: "edit", label: "Accept step", keys: ["ctrl+Enter"],
      help: "Finishes this step. The next one starts from its result.",
      run: () => void (editor.graft.isEdited.value ? editor.graft.accept() : editor.ask({ do: "accept" })),
      enabled: () =>
        editor.graft.isEdited.value ? editor.graft.report.value?.error === undefined : hasHandles(),
    },
    {
      id: "done", group: "edit", label: "Done", keys: [],
      help: "Returns the mesh to the program that opened the editor.",
      run: () => void editor.done(), enabled: () => editor.isWaitedFor.value && editor.isOpen.value,
    },
    {
      id: "confirm", group: "edit", label: "Confirm", keys: ["Enter"],
      help: "Finishes the current move, or closes the curve.",
      run: () => tools.confirm(), enabled: () => tools.canConfirm(),
    },
    {
      id: "escape", group: "edit", label: "Escape: up one level", keys: ["Escape"],
      help: "Cancels the current move; then ends the tour, closes messages, deselects the handle, and leaves the tool.",
      run: () => void (tools.cancelGesture() || page.skipTour() || editor.dismissMessages() || tools.escape()), enabled: () => true,
    },
    {
      id: "help", group: "help", label: "Help", keys: ["?", "F1"],
      help: "Shortcuts and a short tour.",
      run: () => page.help(), enabled: () => true,
    },
    {
      id: "tour", group: "help", label: "Guided tour", keys: [],
      help: "Leads through an edit of a sample.",
      run: () => page.tour(), enabled: () => true,
    },
  ];
}

const toolTable: readonly [ToolName, string, string, string][] = [
  ["navigate", "Navigate", "Q", "Drag to orbit; click a handle to make it active."],
  ["handle", "Handle", "H", "Paint the area to move, then move, rotate and scale it."],
  ["vertex", "Point handle", "P", "Click a vertex to make it a handle."],
  ["curve", "Curve handle", "U", "Click points; the curve follows the edges between them. Enter finishes it."],
  ["brush", "Brush", "B", "Paint a selection. [ and ] change the size of the brush."],
  ["lasso", "Lasso", "L", "Draw around what you want to select."],
  ["box", "Box", "M", "Drag a rectangle around what you want to select."],
  ["connected", "Connected", "C", "Click to select everything connected."],
  ["loop", "Boundary loop", "O", "Click near a hole to select its boundary loop."],
  ["flood", "Flood fill", "W", "Click to select up to the next crease."],
  ["measure", "Measure and scale", "shift+M", "Click two points, and type the length that it should be."],
  ["flat", "Lay flat", "shift+L", "Click the face that should lie on the bed."],
];

function toolCommands({ editor, settings, tools }: CommandContext): Command[] {
  const enabled = () => editor.isOpen.value;
  const canChange = () => enabled() && !editor.graft.isEdited.value;
  return [
    ...toolTable.map(([tool, label, key, help]): Command => ({
      id: `tool-${tool}`, group: "tool", label, keys: [key], help,
      run: () => (settings.tool.value = tool), enabled: changingTools.has(tool) ? canChange : enabled,
      active: () => editor.toolInUse.value === tool,
    })),
    {
      id: "brush-smaller", group: "tool", label: "Smaller brush", keys: ["["], repeats: true,
      help: "Alt+wheel changes the size, too.",
      run: () => tools.resizeBrush(1 / 1.15), enabled,
    },
    {
      id: "brush-larger", group: "tool", label: "Larger brush", keys: ["]"], repeats: true,
      help: "Alt+wheel changes the size, too.",
      run: () => tools.resizeBrush(1.15), enabled,
    },
    {
      id: "through", group: "tool", label: "Select through", keys: ["T"],
      help: "Also selects what is hidden behind the front.",
      run: () => (settings.through.value = !settings.through.value), enabled, active: () => settings.through.value,
    },
  ];
}

const seamMargin = 2; // rings of vertices beside the seam

function selectCommands({ editor, tools }: CommandContext): Command[] {
  const { graft } = editor;
  // In graft mode the selection is the fixed part of the source. It exists only while the fixed part is painted.
  const isOpen = () => editor.isOpen.value && (graft.mode.value !== "graft" || graft.paintsFixed.value);
  const some = () => isOpen() && editor.selected.value > 0;
  const canDeform = () => some() && !graft.paintsFixed.value && !graft.isEdited.value;
  const select = (change: SelectionChange) =>
    void (graft.paintsFixed.value ? graft.selectFixed(change) : editor.ask({ do: "select", ...change }));
  const grow = (rings: number) => select({ how: "grow", rings });
  const seam = () => graft.seam.value;
  const hasSeam = () =>
    isOpen() && graft.mode.value === "deform" && seam() !== null && seam()?.vertexCount === editor.state.value?.model.vertices;
  const selectSeam = async () => {
    const indices = Array.from(seam()?.vertices ?? []);
    if ((await editor.ask({ do: "select", how: "set", what: { indices } })) === undefined) return false;
    return (await editor.ask({ do: "select", how: "grow", rings: seamMargin })) !== undefined;
  };
  const relaxSeam = async () => {
    const strength = editor.tools.shapeStrength.value;
    if (await selectSeam()) await editor.shape({ do: "sculpt", action: "smooth", strength });
  };
  return [
    {
      id: "select-all", group: "select", label: "Select all", keys: ["A", "ctrl+A"],
      help: "Selects every vertex.",
      run: () => select({ how: "set", what: "all" }), enabled: isOpen,
    },
    {
      id: "select-none", group: "select", label: "Deselect all", keys: ["alt+A", "shift+A"],
      help: "Clears the selection.",
      run: () => select({ how: "set", what: { indices: [] } }), enabled: some,
    },
    {
      id: "select-invert", group: "select", label: "Invert", keys: ["I", "ctrl+I"],
      help: "Swaps what is selected and what is not.",
      run: () => select({ how: "invert" }), enabled: isOpen,
    },
    {
      id: "select-grow", group: "select", label: "Grow", keys: ["+", "=", "ctrl++"], repeats: true,
      help: "Adds the next ring of vertices.",
      run: () => grow(1), enabled: some,
    },
    {
      id: "select-shrink", group: "select", label: "Shrink", keys: ["-", "ctrl+-"], repeats: true,
      help: "Removes the outermost ring of vertices.",
      run: () => grow(-1), enabled: some,
    },
    {
      id: "select-seam", group: "select", label: "Select the seam", keys: [],
      help: "Selects the seam of the latest graft with a margin, to smooth it.",
      run: () => void selectSeam(), enabled: hasSeam,
    },
    {
      id: "relax-seam", group: "select", label: "Relax the seam", keys: [],
      help: "Smooths the seam of the latest graft with a margin, as a step whose strength can be changed under Steps.",
      run: () => void relaxSeam(), enabled: () => hasSeam() && editor.mending.canMend.value,
    },
    {
      id: "mirror-graft", group: "select", label: "Mirrored copy", keys: [],
      help: "Grafts the same part on the other side, as a mirror image: at the plane of Symmetry, or else between left and right.",
      run: () => void editor.mirrorGraft(), enabled: () => partToMirror(editor) !== undefined,
    },
    {
      id: "make-handle", group: "select", label: "Make handle", keys: ["shift+H"],
      help: "Makes a handle of the selected vertices.",
      run: () => tools.handleFromSelection(), enabled: canDeform,
    },
    {
      id: "make-region", group: "select", label: "Make region", keys: ["shift+E"],
      help: "Only the selected vertices may move.",
      run: () => void editor.ask({ do: "region" }), enabled: canDeform,
    },
    {
      id: "make-fixed", group: "select", label: "Make fixed", keys: ["shift+X"],
      help: "The selected vertices stay where they are.",
      run: () => void editor.ask({ do: "fixed" }), enabled: canDeform,
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
    help: `${label} with the pointer. X, Y or Z locks to an axis; type a number for an exact value; Enter or a click confirms.`,
    run: () => tools.beginGesture(kind), enabled: active,
  });
  return [
    gesture("move", "Move", "G"),
    gesture("turn", "Rotate", "R"),
    gesture("scale", "Scale", "S"),
    {
      id: "pivot", group: "handle", label: "Move pivot", keys: ["D"],
      help: "Drag the point about which the handle rotates and scales.",
      run: () => tools.togglePivot(), enabled: active, active: () => settings.movesPivot.value,
    },
    {
      id: "pivot-reset", group: "handle", label: "Reset pivot", keys: ["shift+D"],
      help: "Moves the pivot to the centre of the handle's boundary.",
      run: () => tools.resetPivot(), enabled: active,
    },
    {
      id: "gizmo-space", group: "handle", label: "Local axes", keys: ["K"],
      help: "The gizmo follows the handle's own axes, or the world's.",
      run: () => (settings.gizmoSpace.value = settings.gizmoSpace.value === "local" ? "world" : "local"),
      enabled: () => editor.isOpen.value, active: () => settings.gizmoSpace.value === "local",
    },
    {
      id: "snap", group: "handle", label: "Snap", keys: ["shift+S"],
      help: "Moves, rotates and scales in steps. Hold Ctrl to snap one drag.",
      run: () => (settings.snap.value = !settings.snap.value),
      enabled: () => editor.isOpen.value, active: () => settings.snap.value,
    },
    {
      id: "reset-pose", group: "handle", label: "Reset handle", keys: ["alt+G"],
      help: "Returns the handle to where it was at the start of the step.",
      run: () => tools.resetPose(), enabled: active,
    },
    {
      id: "symmetry", group: "handle", label: "Symmetry", keys: ["Y"],
      help: "Mirrors every edit across a plane.",
      run: () => void editor.setSymmetry(!isSymmetric()),
      enabled: () => editor.isOpen.value && !editor.graft.isEdited.value, active: isSymmetric,
    },
    {
      id: "remove-handle", group: "handle", label: "Remove handle", keys: ["Delete", "Backspace"],
      help: "Removes the handle. The mesh keeps its vertices.",
      run: () => tools.removeHandle(), enabled: active,
    },
    {
      id: "next-handle", group: "handle", label: "Next handle", keys: ["N"],
      help: "Makes the next handle active.",
      run: () => tools.stepHandle(1), enabled: several,
    },
    {
      id: "previous-handle", group: "handle", label: "Previous handle", keys: ["shift+N"],
      help: "Makes the previous handle active.",
      run: () => tools.stepHandle(-1), enabled: several,
    },
  ];
}

const sides: readonly [AxisView, string, readonly string[]][] = [
  ["front", "Front view", ["1", "Num1"]],
  ["back", "Back view", ["2", "ctrl+Num1"]],
  ["right", "Right view", ["3", "Num3"]],
  ["left", "Left view", ["4", "ctrl+Num3"]],
  ["top", "Top view", ["7", "Num7"]],
  ["bottom", "Bottom view", ["8", "ctrl+Num7"]],
];

function viewCommands({ editor, view, viewport }: CommandContext): Command[] {
  const enabled = () => editor.isOpen.value;
  return [
    {
      id: "before", group: "view", label: "Show before", keys: ["\\", "`"],
      help: "Shows the mesh as it was before this step, while the key is held.",
      run: () => (view.before.value = true), release: () => (view.before.value = false),
      enabled, active: () => view.before.value,
    },
    {
      id: "fit", group: "view", label: "Fit", keys: ["F", "Num."],
      help: "Frames the active handle, the selection, or everything.",
      run: () => viewport.fit(viewport.inFocus() ?? "all"), enabled,
    },
    {
      id: "fit-all", group: "view", label: "Fit all", keys: ["Home", "shift+F"],
      help: "Frames everything.",
      run: () => viewport.fit("all"), enabled,
    },
    ...sides.map(([side, label, keys]): Command => ({
      id: `look-${side}`, group: "view", label, keys, help: `Shows the model from the ${side}.`,
      run: () => viewport.lookFrom(side), enabled,
    })),
    {
      id: "projection", group: "view", label: "Orthographic", keys: ["5", "Num5"],
      help: "Switches between perspective and orthographic.",
      run: () => viewport.toggleProjection(), enabled,
    },
    {
      id: "wireframe", group: "view", label: "Wireframe", keys: ["Z"],
      help: "Shows the edges of the mesh.",
      run: () => (view.wireframe.value = !view.wireframe.value), enabled, active: () => view.wireframe.value,
    },
    {
      id: "panels", group: "view", label: "Panels", keys: ["J"],
      help: "Shows or hides the panels at the right.",
      run: () => (view.panels.value = !view.panels.value), enabled, active: () => view.panels.value,
    },
  ];
}
