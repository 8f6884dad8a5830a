import type { Viewport } from "../view/viewport";
import type { ViewActions } from "./commands";
import type { Editor } from "./editor";

/** Makes the actions of the view that commands can call. */
export function viewActions(editor: Editor, viewport: Viewport): ViewActions {
  return {
    fit: (what) => viewport.fit(what),
    inFocus: () => viewport.main?.handles.get(editor.tools.activeHandle.value ?? "") ?? selected(viewport),
    lookFrom: (side) => viewport.lookFrom(side),
    toggleProjection: () => (editor.view.orthographic.value = !editor.view.orthographic.value),
  };
}

function selected(viewport: Viewport): Uint32Array | undefined {
  const vertices: number[] = [];
  viewport.main?.selection.forEach((is, v) => is !== 0 && vertices.push(v));
  return vertices.length > 0 ? Uint32Array.from(vertices) : undefined;
}
