import type { ToolActions } from "./commands";
import type { Editor } from "./editor";

/** What of the tools' commands needs the engine alone. */
export function engineTools(editor: Editor): Omit<ToolActions, "confirm" | "canConfirm" | "beginGesture"> {
  const { tools } = editor;
  const handles = () => editor.state.value?.handles ?? [];
  const active = () => handles().find(({ name }) => name === tools.activeHandle.value);
  const withActive = (act: (handle: NonNullable<ReturnType<typeof active>>) => void) => {
    const handle = active();
    if (handle !== undefined) act(handle);
  };
  return {
    escape: () => {
      if (tools.movesPivot.value) tools.movesPivot.value = false;
      else if (tools.activeHandle.value !== null) tools.activeHandle.value = null;
      else tools.tool.value = "navigate";
    },
    togglePivot: () => (tools.movesPivot.value = !tools.movesPivot.value),
    resetPivot: () =>
      withActive(({ name, pose: { pivot: _, ...pose } }) => void editor.pose({ [name]: pose })),
    resetPose: () => withActive(({ name }) => void editor.pose({ [name]: {} })),
    removeHandle: () => withActive(({ name }) => void editor.ask({ do: "handle", what: "remove", name })),
    handleFromSelection: () => void editor.holdSelection(),
    stepHandle: (by) => {
      const all = handles();
      if (all.length === 0) return;
      const at = all.findIndex(({ name }) => name === tools.activeHandle.value);
      const next = at < 0 ? (by > 0 ? 0 : all.length - 1) : (at + by + all.length) % all.length;
      tools.activeHandle.value = all[next]?.name ?? null;
    },
    resizeBrush: (factor) =>
      (tools.brushRadiusPx.value = Math.min(400, Math.max(2, tools.brushRadiusPx.value * factor))),
  };
}
