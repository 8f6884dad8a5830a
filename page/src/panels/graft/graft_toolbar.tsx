import type { GraftTool } from "../../app/graft/graft";
import type { Page } from "../../app/page";
import { pointerKind } from "../../app/pointer_kind";
import { CommandButton } from "../command_button";
import { BrushSize } from "../tool_options";
import { ToolRail } from "../toolbar";
import { Button, IconButton } from "../ui/button";
import type { IconName } from "../ui/icon";

const tools: readonly { tool: GraftTool; label: string; icon: IconName; tip: string }[] = [
  {
    tool: "loops",
    label: "Pair loops",
    icon: "loop",
    tip: "Click a loop on each mesh to pair them; drag the markers along the loops.",
  },
  { tool: "plane", label: "Cut by a plane", icon: "cut-plane", tip: "Draw a line across the model. The plane passes through it, away from you." },
  { tool: "stroke", label: "Cut along a curve", icon: "cut-curve", tip: "Draw a closed curve on the surface." },
];

const hints: Record<GraftTool, string> = {
  loops: "Drag beside the models to orbit, right-drag to pan, wheel to zoom.",
  plane: "The line may begin and end beside the model. Arrows move the plane, rings rotate it.",
  stroke: "Orbit between strokes to get around. Enter closes the curve, Backspace removes the last point.",
  fixed: "Paint the area of the part that must not bend. Alt subtracts.",
  drop: "Wheel or R spins, Shift+wheel or S scales, Alt+wheel or B raises the cut of a closed part, T tilts it, Esc cancels.",
};

/** Hints where fingers do it another way. */
const touchHints: Partial<Record<GraftTool, string>> = {
  loops: "Tap a loop on each mesh. Drag beside the models to orbit, two fingers to pan and zoom.",
  stroke: "Draw around the piece to cut off. Two fingers move and zoom the view.",
  fixed: "Paint the area of the part that must not bend.",
  drop: "Tap the place on the surface.",
};

/** The tools of graft mode, at the left. */
export function GraftToolbar({ page }: { page: Page }) {
  const { graft } = page.editor;
  const busy = graft.isEdited.value;
  return (
    <ToolRail>
      <div class="tool-groups" role="toolbar" aria-orientation="vertical" aria-label="Tools">
      <div class="tool-group">
        {tools.map(({ tool, label, icon, tip }) => (
          <IconButton
            key={tool}
            label={label}
            icon={icon}
            tip={tool !== "loops" && busy ? "Accept or cancel the graft first." : tip}
            pressed={graft.tool.value === tool}
            disabled={tool !== "loops" && busy}
            onClick={() => (graft.tool.value = tool)}
          />
        ))}
      </div>
      </div>
    </ToolRail>
  );
}

/** A hint on the active tool, above the view. */
export function GraftToolHint({ page }: { page: Page }) {
  const { graft, tools: settings } = page.editor;
  const tool = graft.tool.value;
  const posed = tool === "loops" && graft.step.value?.pose === "keep";
  return (
    <div class="tool-options" data-homes="top low">
      <div class="tool-line">
        {tool === "fixed" && <BrushSize tools={settings} />}
        <span class="tool-hint">
          {posed
            ? "Move, rotate and scale the part with the gizmo. It bends near its loops only."
            : tool === "loops" && graft.step.value?.at !== undefined
              ? "To graft it elsewhere, drag the part from the list Parts."
              : tool === "loops" && graft.pairs.value.length > 0
                ? "Drag the numbered markers along their loops. Drag beside the models to orbit."
                : ((pointerKind.value === "touch" ? touchHints[tool] : undefined) ?? hints[tool])}
        </span>
        {tool === "fixed" && (
          <>
            <CommandButton page={page} id="select-grow" icon="grow" />
            <CommandButton page={page} id="select-shrink" icon="shrink" />
            <CommandButton page={page} id="select-invert" icon="invert" />
          </>
        )}
        {(tool === "fixed" || tool === "drop") && (
          <Button
            label={tool === "fixed" ? "Done" : "Cancel"}
            kind="quiet"
            onClick={() => (tool === "fixed" ? graft.donePainting() : (graft.tool.value = "loops"))}
          />
        )}
      </div>
    </div>
  );
}
