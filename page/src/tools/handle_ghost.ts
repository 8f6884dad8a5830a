import type { Viewport } from "../view/viewport";
import type { HandleControl } from "./handle_control";
import { isRedrawn, matrixOf } from "./pose_math";
import type { Preview } from "./preview";

/**
 * Shows a handle's own vertices at the placement of a gesture. They are visible at once, even while the engine still
 * sets up.
 */
export class HandleGhost {
  private shown: string | undefined;

  constructor(
    private readonly viewport: Viewport,
    private readonly control: HandleControl,
    private readonly preview: Preview,
    private readonly isGoing: () => boolean,
  ) {
    viewport.onFrame.add(() => this.draw());
  }

  private draw(): void {
    const handle = this.control.active;
    const surface = this.viewport.main;
    if (handle === undefined || surface === undefined || !this.isGoing() || isRedrawn(handle.placement)) {
      if (this.shown !== undefined) this.preview.hide();
      this.shown = undefined;
      return;
    }
    const map = matrixOf(handle.placement);
    if (this.shown === handle.name) return this.preview.setMap(surface, map);
    this.shown = handle.name;
    this.preview.show(surface, handle.vertices, map);
  }
}
