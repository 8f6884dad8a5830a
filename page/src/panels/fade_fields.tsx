import { usualReach } from "../app/shaping";
import type { Unit } from "../app/units";
import { Segments, Slider } from "./ui/fields";

interface FadeProps {
  /** Model units along edges; null: the movement fades inside the region. */
  reach: number | null;
  unit: Unit;
  diagonal: number;
  onChange: (reach: number | null) => void;
}

/** Where the movement of a shaped region fades out: inside the region, or around it within a reach. */
export function FadeFields({ reach, unit, diagonal, onChange }: FadeProps) {
  return (
    <>
      <Segments
        label="Fade"
        value={reach === null ? "inside" : "around"}
        choices={[
          { value: "inside", label: "Inside", help: "Nothing around moves." },
          { value: "around", label: "Around", help: "All of it moves, and the surface around follows within the reach." },
        ]}
        onChange={(where) => onChange(where === "inside" ? null : usualReach(diagonal))}
      />
      {reach !== null && (
        <Slider
          label="Reach"
          min={0}
          max={Infinity}
          softMax={0.5 * diagonal}
          logarithmic
          digits={3}
          quantity="length"
          unit={unit}
          suffix={unit === "none" ? "" : unit}
          step={0.01 * diagonal}
          value={reach}
          help="How far around the surface follows, along its edges. 0 makes a hard edge."
          onChange={onChange}
        />
      )}
    </>
  );
}
