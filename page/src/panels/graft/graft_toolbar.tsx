import type { GraftTool } from "../../app/graft/graft";
import type { Page } from "../../app/page";
import { CommandButton } from "../command_button";
import { BrushSize } from "../tool_options";
import { Button, IconButton } from "../ui/button";
import type { IconName } from "../ui/icon";

const tools: readonly { tool: GraftTool; label: string; icon: IconName; tip: string }[] = [
  {
    tool: "loops",
    label: "Pair loops",
    icon: "loop",
    tip: "Click a loop on each to pair them; drag what meets along them.",
  },
  { tool: "plane", label: "Cut by a plane", icon: "cut-plane", tip: "Draw a line across the model: the plane goes through it and your eye." },
  { tool: "stroke", label: "Cut along a curve", icon: "cut-curve", tip: "Draw a closed curve on the surface." },
];

const hints: Record<GraftTool, string> = {
  loops: "Click a loop on each of two models to pair them. Drag beside the models to turn the view.",
  plane: "Draw a line across the model, also from beside it; move and turn the plane by its arrows and rings.",
  stroke: "Draw a closed curve on the surface; turn the view between strokes to go round.",
  fixed: "Paint what of the part must stay as it is. Alt takes away.",
  drop: "Point where the part is to grow. Wheel or R spins, shift+wheel or S scales, a click grafts it, Esc leaves it.",
};

/** The tools of graft mode, at the left. */
export function GraftToolbar({ page }: { page: Page }) {
  const { graft } = page.editor;
  const busy = graft.kept.value !== undefined;
  return (
    <div class="toolbar" role="toolbar" aria-orientation="vertical" aria-label="Tools">
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
  );
}

/** A hint on the active tool, above the view. */
export function GraftToolHint({ page }: { page: Page }) {
  const { graft, tools: settings } = page.editor;
  const tool = graft.tool.value;
  const busy = graft.kept.value !== undefined;
  const posed = tool === "loops" && graft.step.value?.pose === "keep";
  return (
    <div class="tool-options">
      <div class="tool-line">
        {tool === "fixed" && <BrushSize tools={settings} />}
        <span class="tool-hint">
          {posed
            ? "Move, turn and scale the part by its gizmo; it gives way near its loops alone."
            : tool === "loops" && graft.step.value?.at !== undefined
              ? "Spin, size and angle are at the right. Drag the part from its list to put it elsewhere."
              : tool === "loops" && !busy && graft.model.value?.loops === 0
              ? "The model is closed: cut it open by a plane or along a curve, or drop a part on its surface."
              : hints[tool]}
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
            label={tool === "fixed" ? "Done" : "Leave it"}
            kind="quiet"
            onClick={() => (tool === "fixed" ? graft.donePainting() : (graft.tool.value = "loops"))}
          />
        )}
      </div>
    </div>
  );
}
