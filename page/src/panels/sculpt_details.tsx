import type { DetailsProps } from "./step_details";
import { FadeFields } from "./fade_fields";
import { StepNotes } from "./step_notes";
import { NumberField, Slider } from "./ui/fields";

/** How strongly a step smooths or flattens, or how high it inflates, and where that fades out. */
export function SculptDetails({ page, step: { fields, found }, index }: DetailsProps) {
  const { action, strength = 0.5, height = 0, reach = null, symmetry } = fields as {
    action?: string;
    strength?: number;
    height?: number;
    reach?: number | null;
    symmetry?: object;
  };
  const onBothSides = symmetry !== undefined && (
    <>
      <p class="hint">Its mirror image is shaped, too, at the plane that Symmetry had then.</p>
      <StepNotes page={page} notes={found?.notes} />
    </>
  );
  const unit = page.editor.view.unit.value;
  const change = (changes: { strength?: number; height?: number; reach?: number | null }) =>
    void page.editor.ask({ do: "step", what: "change", index, fields: changes });
  const diagonal = page.editor.state.value?.model.diagonal ?? 1;
  const fade = <FadeFields reach={reach} unit={unit} diagonal={diagonal} onChange={(to) => change({ reach: to })} />;
  if (action === "inflate")
    return (
      <div class="step-details">
        <label class="row">
          <span id={`height-${index}`}>Height</span>
          <NumberField
            label="Height"
            labelledBy={`height-${index}`}
            value={height}
            quantity="length"
            unit={unit}
            suffix={unit === "none" ? "" : unit}
            step={0.01 * diagonal}
            tip={`${reach === null ? "Of the middle. " : ""}A negative number makes a dent.`}
            onChange={(to) => change({ height: to })}
          />
        </label>
        {fade}
        {onBothSides}
      </div>
    );
  return (
    <div class="step-details">
      <Slider
        label={action === "flatten" ? "Flatten" : "Smooth"}
        min={0}
        max={1}
        step={0.05}
        digits={2}
        value={strength}
        help={action === "flatten" ? (reach === null ? "1 makes the middle flat." : "1 makes it flat.") : "1 leaves hardly anything of the old shape; the surface around decides."}
        onChange={(to) => change({ strength: to })}
      />
      {action === "flatten" && fade}
      {onBothSides}
    </div>
  );
}
