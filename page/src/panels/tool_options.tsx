import type { Page } from "../app/page";
import { pointerKind } from "../app/pointer_kind";
import type { ToolName, ToolSettings } from "../app/tool_settings";
import { scalingPose } from "../app/placing";
import { counted } from "../app/units";
import { CommandButton, CommandLabelButton } from "./command_button";
import { inflatedHeight } from "../app/shaping";
import { FadeFields } from "./fade_fields";
import { Button } from "./ui/button";
import { NumberField, Segments, Slider } from "./ui/fields";

const hints: Record<ToolName, string> = {
  navigate: "Drag to orbit, right-drag to pan, wheel to zoom.",
  handle: "Paint the area to move, then drag the gizmo.",
  vertex: "Click a vertex to make it a handle.",
  curve: "Click points along the curve. Enter finishes it; a click on the first point closes it.",
  brush: "Paint to select.",
  lasso: "Draw around what to select.",
  box: "Drag a rectangle around what to select.",
  connected: "Click to select everything connected.",
  loop: "Click near a hole to select its boundary loop.",
  flood: "Click to select up to the next crease.",
  measure: "Click two points on the model.",
  flat: "Click the face that should lie on the bed.",
};
/** Hints where fingers do it another way. */
const touchHints: Partial<Record<ToolName, string>> = {
  navigate: "Drag to orbit, two fingers to pan and zoom.",
  vertex: "Tap a vertex to make it a handle.",
  curve: "Tap points along the curve. Finish ends it; a tap on the first point closes it.",
  connected: "Tap to select everything connected.",
  loop: "Tap near a hole to select its boundary loop.",
  flood: "Tap to select up to the next crease.",
  measure: "Tap two points on the model.",
  flat: "Tap the face that should lie on the bed.",
};
const modifierHints = { set: "Shift adds, Alt subtracts.", add: "Alt subtracts.", remove: "Shift adds." };
const painting: readonly ToolName[] = ["handle", "brush"];
const selecting: readonly ToolName[] = ["brush", "lasso", "box", "connected", "loop", "flood"];
const seesThrough: readonly ToolName[] = ["handle", "brush", "lasso", "box"];

/** The radius of all painting tools. */
export function BrushSize({ tools }: { tools: ToolSettings }) {
  return (
    <Slider
      label="Size"
      value={tools.brushRadiusPx.value}
      min={2}
      max={400}
      softMax={200}
      logarithmic
      integer
      suffix="px"
      help="Radius of the brush, also changed by [ and ]."
      onInput={(radius) => (tools.brushRadiusPx.value = radius)}
      onChange={(radius) => (tools.brushRadiusPx.value = radius)}
    />
  );
}

/** The options of the active tool, and actions on the selection, above the view. */
export function ToolOptions({ page }: { page: Page }) {
  const { editor } = page;
  const { tools } = editor;
  const tool = editor.toolInUse.value;
  const selected = editor.selected.value;
  return (
    <div class="tool-options" data-homes="top low">
      <div class="tool-line" role="toolbar" aria-label="Tool options">
        {painting.includes(tool) && <BrushSize tools={tools} />}
        {tool === "flood" && (
          <Slider
            label="Crease angle"
            value={tools.floodAngleDeg.value}
            min={0}
            max={180}
            integer
            suffix="°"
            help="The selection stops at creases sharper than this angle."
            onChange={(angle) => (tools.floodAngleDeg.value = angle)}
          />
        )}
        {selecting.includes(tool) && (
          <Segments
            label="Selection"
            hideLabel
            value={tools.combine.value}
            choices={[
              { value: "set", label: "New", help: "Starts a new selection." },
              { value: "add", label: "Add", help: "Adds to the selection (Shift)." },
              { value: "remove", label: "Subtract", help: "Subtracts from the selection (Alt)." },
            ]}
            onChange={(how) => (tools.combine.value = how)}
          />
        )}
        {tool === "measure" && <MeasuredLength page={page} />}
        {seesThrough.includes(tool) && <CommandButton page={page} id="through" icon="through" />}
        <span class="tool-hint">
          {pointerKind.value === "touch"
            ? (touchHints[tool] ?? hints[tool])
            : `${hints[tool]} ${selecting.includes(tool) ? modifierHints[tools.combine.value] : ""}`}
        </span>
        {tool === "curve" && <FinishCurve page={page} />}
      </div>
      {selected > 0 && <SelectionLine page={page} selected={selected} />}
      {selected > 0 && <ShapeLine page={page} />}
      {tools.activeHandle.value !== null && <HandleLine page={page} />}
    </div>
  );
}

/** Ends a curve, for those who have no Enter key. */
function FinishCurve({ page }: { page: Page }) {
  return pointerKind.value === "touch" ? <CommandLabelButton page={page} id="confirm" icon="accept" label="Finish" /> : null;
}

/** The length between two clicked points. Another one scales the whole model. */
function MeasuredLength({ page }: { page: Page }) {
  const { editor, shownBox } = page;
  const { measured } = editor.tools;
  const unit = editor.view.unit.value;
  const { value: length } = measured;
  const { value: box } = shownBox;
  if (length === null || box === null) return null;
  const scaleTo = async (wanted: number) => {
    const up = page.viewport.navigation.axes()[2].toArray();
    const pose = scalingPose(wanted / length, box, up);
    if ((await editor.ask({ do: "transform", pose })) !== undefined) measured.value = null;
  };
  return (
    <>
      <strong>Length</strong>
      <NumberField
        label="Length"
        tip="Type the length that it should be: the whole model is scaled."
        value={length}
        quantity="length"
        unit={unit}
        suffix={unit === "none" ? "" : unit}
        above={0}
        disabled={editor.graft.isEdited.value}
        onChange={(wanted) => void scaleTo(wanted)}
      />
    </>
  );
}

function SelectionLine({ page, selected }: { page: Page; selected: number }) {
  return (
    <div class="tool-line selection-line" role="toolbar" aria-label="Selection">
      <strong>{counted(selected, "vertex", "vertices")} selected</strong>
      <CommandButton page={page} id="select-grow" icon="grow" />
      <CommandButton page={page} id="select-shrink" icon="shrink" />
      <CommandButton page={page} id="select-invert" icon="invert" />
      <CommandButton page={page} id="select-none" icon="close" />
      <span class="divider" />
      <CommandLabelButton page={page} id="make-handle" icon="handle" kind="primary" />
      <CommandLabelButton page={page} id="make-region" icon="region" />
      <CommandLabelButton page={page} id="make-fixed" icon="fixed" />
    </div>
  );
}

/** Shapes what is selected, each time as a step. */
function ShapeLine({ page }: { page: Page }) {
  const { editor, viewport } = page;
  const { shapeStrength, shapeReach } = editor.tools;
  const canShape = editor.mending.canMend.value; // no graft is open
  const strength = shapeStrength.value;
  const reach = shapeReach.value;
  const fading = reach === null ? {} : { reach };
  const inflate = (sign: 1 | -1) => {
    const surface = viewport.main;
    if (surface === undefined) return;
    void editor.shape({ do: "sculpt", action: "inflate", height: sign * inflatedHeight(surface, strength), ...fading });
  };
  return (
    <div class="tool-line shape-line" role="toolbar" aria-label="Shape">
      <Button label="Smooth" disabled={!canShape} tip="Removes detail; keeps how the surface around meets it." onClick={() => void editor.shape({ do: "sculpt", action: "smooth", strength })} />
      <Button label="Flatten" disabled={!canShape} tip="Moves it towards its plane." onClick={() => void editor.shape({ do: "sculpt", action: "flatten", strength, ...fading })} />
      <Button label="Inflate" disabled={!canShape} tip={reach === null ? "Raises its middle." : "Raises it."} onClick={() => inflate(1)} />
      <Button label="Dent" disabled={!canShape} tip={reach === null ? "Lowers its middle." : "Lowers it."} onClick={() => inflate(-1)} />
      <Slider
        label="Strength"
        min={0.05}
        max={1}
        step={0.05}
        digits={2}
        value={strength}
        help="How much each of these does. It can be changed later, under Steps."
        onChange={(to) => (shapeStrength.value = to)}
      />
      <FadeFields
        reach={reach}
        unit={editor.view.unit.value}
        diagonal={editor.state.value?.model.diagonal ?? 1}
        onChange={(to) => (shapeReach.value = to)}
      />
    </div>
  );
}

/** The options of the gizmo of the active handle. */
function HandleLine({ page }: { page: Page }) {
  const { tools, view, state } = page.editor;
  const unit = view.unit.value;
  const usualMove = 0.01 * (state.value?.model.diagonal ?? 1);
  return (
    <div class="tool-line handle-line" role="toolbar" aria-label="Gizmo">
      <strong data-tip={tools.activeHandle.value}>{tools.activeHandle.value}</strong>
      <CommandButton page={page} id="gizmo-space" icon="gizmo-space" />
      <CommandButton page={page} id="pivot" icon="pivot" />
      <CommandButton page={page} id="snap" icon="snap" />
      {tools.snap.value && (
        <>
          <NumberField
            label="Move step"
            tip="Snapping step of moves."
            value={tools.snapMove.value === 0 ? usualMove : tools.snapMove.value}
            quantity="length"
            unit={unit}
            suffix={unit === "none" ? "" : unit}
            min={1e-9}
            digits={3}
            step={usualMove}
            onChange={(step) => (tools.snapMove.value = step)}
          />
          <NumberField
            label="Rotation step"
            tip="Snapping step of rotations."
            value={tools.snapTurnDeg.value}
            quantity="angle"
            suffix="°"
            min={0.01}
            max={180}
            step={5}
            onChange={(step) => (tools.snapTurnDeg.value = step)}
          />
          <NumberField
            label="Step of scales"
            tip="Step of scales."
            value={tools.snapScale.value}
            quantity="factor"
            suffix="×"
            min={0.001}
            max={10}
            step={0.05}
            onChange={(step) => (tools.snapScale.value = step)}
          />
        </>
      )}
      <CommandButton page={page} id="reset-pose" icon="reset" />
      <CommandButton page={page} id="remove-handle" icon="remove" />
    </div>
  );
}
