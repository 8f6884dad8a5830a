import { Vector3 } from "three";
import type { Viewport } from "../view/viewport";
import type { AxisView, ViewActions } from "./commands";
import type { Editor } from "./editor";

/** Makes the actions of the view that commands can call. */
export function viewActions(editor: Editor, viewport: Viewport): ViewActions {
  return {
    fit: (what) => viewport.fit(what),
    inFocus: () => viewport.main?.handles.get(editor.tools.activeHandle.value ?? "") ?? selected(viewport),
    lookFrom: (side) => viewport.lookAlong(directionFrom(side, isZUp(viewport))),
    toggleProjection: () => (editor.view.orthographic.value = !editor.view.orthographic.value),
  };
}

function selected(viewport: Viewport): Uint32Array | undefined {
  const vertices: number[] = [];
  viewport.main?.selection.forEach((is, v) => is !== 0 && vertices.push(v));
  return vertices.length > 0 ? Uint32Array.from(vertices) : undefined;
}

function isZUp(viewport: Viewport): boolean {
  return viewport.navigation.up === "z";
}

/** Returns the viewing direction from one side of the model. The front faces -y if z is up, and z if y is up. */
export function directionFrom(side: AxisView, zUp: boolean): Vector3 {
  const ahead = zUp ? new Vector3(0, 1, 0) : new Vector3(0, 0, -1);
  const up = zUp ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
  const right = ahead.clone().cross(up);
  const directions: Record<AxisView, Vector3> = {
    front: ahead,
    back: ahead.clone().negate(),
    right: right.clone().negate(),
    left: right,
    top: up.clone().negate(),
    bottom: up,
  };
  return directions[side];
}
