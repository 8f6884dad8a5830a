import type { Hit } from "../../view/picking/picking";
import { BrushTool } from "../select_tools";
import type { ToolContext, Pointer, Stroke, Tool } from "../tool";

/** Paints the fixed vertices of a part that keeps its pose. */
export class FixedTool implements Tool {
  readonly cursor = "crosshair";
  private readonly brush: BrushTool;

  constructor(private readonly context: ToolContext) {
    this.brush = new BrushTool(context);
  }

  hover(pointer: Pointer): void {
    this.brush.hover(pointer);
  }
  leave(): void {
    this.brush.leave();
  }

  press(pointer: Pointer, hit: Hit | undefined): Stroke | undefined {
    const { graft } = this.context.editor;
    if (hit === undefined || hit.surface.id !== graft.source.value?.mesh) return undefined;
    const stroke = this.brush.press(pointer, hit);
    return (
      stroke && {
        ...stroke,
        end: (at) => {
          stroke.end(at);
          void graft.set({ fixed: true });
        },
      }
    );
  }
}
