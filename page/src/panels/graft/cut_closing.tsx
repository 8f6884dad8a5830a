import type { CutClosing, Pins } from "../../app/cuts";
import type { Unit } from "../../app/units";
import { NumberField, Segments, Toggle } from "../ui/fields";

interface CutClosingProps {
  closing: CutClosing;
  unit: Unit;
  /** The diagonal of the model's box, in model units. */
  diagonal: number;
  onChange: (closing: CutClosing) => void;
}

/** Shows how the halves of a cut by a plane are closed, and the sizes of pins. */
export function CutClosingFields({ closing, unit, diagonal, onChange }: CutClosingProps) {
  const pins = closing.pins ?? {};
  const setPins = (changes: Pins) => onChange({ cap: "pins", pins: { ...pins, ...changes } });
  const sizesGiven = pins.diameter !== undefined;
  return (
    <>
      <Segments
        label="Close"
        value={closing.cap}
        choices={[
          { value: "open", label: "No", help: "Leaves the cut open, as a graft needs it." },
          { value: "flat", label: "Flat", help: "Closes both halves, so that they can be printed." },
          { value: "pins", label: "Pins", help: "Closes both halves, with pins on one and holes in the other, for gluing." },
        ]}
        onChange={(cap) => onChange(cap === "pins" ? { cap, pins } : { cap })}
      />
      {closing.cap === "pins" && (
        <>
          <label class="row">
            <span id="pin-count">Pins</span>
            <NumberField
              label="Pins"
              labelledBy="pin-count"
              value={pins.count ?? 2}
              integer
              min={1}
              max={32}
              tip="On each cut face. The number is smaller where there is no room."
              onChange={(count) => setPins({ count })}
            />
          </label>
          <Segments
            label="Pins on"
            value={pins.side ?? "below"}
            choices={[
              { value: "above", label: "Blue side" },
              { value: "below", label: "Red side" },
            ]}
            onChange={(side) => setPins({ side })}
          />
          <Toggle
            label="Automatic sizes"
            value={!sizesGiven}
            help="Follow from the size of the cut: as thick as fits well, 1.5 times as long, with a gap of 5 % all round."
            onChange={(automatic) =>
              onChange({ cap: "pins", pins: automatic ? without(pins) : { ...pins, ...usualSizes(diagonal, unit) } })
            }
          />
          {sizesGiven && (
            <>
              <Length label="Diameter" value={pins.diameter} {...{ unit, diagonal }} onChange={(diameter) => setPins({ diameter })} />
              <Length label="Length" value={pins.length ?? 0} {...{ unit, diagonal }} onChange={(length) => setPins({ length })} />
              <Length
                label="Gap"
                value={pins.clearance ?? 0}
                tip="By how much a hole is wider than its pin, all round, and deeper."
                mayBeZero
                {...{ unit, diagonal }}
                onChange={(clearance) => setPins({ clearance })}
              />
            </>
          )}
        </>
      )}
    </>
  );
}

/** Sizes to begin with: pins of 5 mm with a gap of 0.2 mm, or by the size of a model without a unit. */
function usualSizes(diagonal: number, unit: Unit): Pins {
  const mm = { µm: 1000, mm: 1, cm: 0.1, m: 0.001, in: 1 / 25.4, ft: 1 / 304.8 };
  const diameter = unit === "none" ? Number((0.03 * diagonal).toPrecision(2)) : 5 * mm[unit];
  return { diameter, length: 1.5 * diameter, clearance: 0.04 * diameter };
}

function without({ count, side }: Pins): Pins {
  return { ...(count !== undefined && { count }), ...(side !== undefined && { side }) };
}

interface LengthProps {
  label: string;
  value: number | undefined;
  unit: Unit;
  diagonal: number;
  tip?: string;
  mayBeZero?: boolean;
  onChange: (value: number) => void;
}

function Length({ label, value = 0, unit, diagonal, tip, mayBeZero = false, onChange }: LengthProps) {
  const id = `pin-${label.toLowerCase()}`;
  return (
    <label class="row">
      <span id={id}>{label}</span>
      <NumberField
        label={label}
        labelledBy={id}
        value={value}
        quantity="length"
        unit={unit}
        suffix={unit === "none" ? "" : unit}
        step={0.002 * diagonal}
        {...(mayBeZero ? { min: 0 } : { above: 0 })}
        {...(tip !== undefined && { tip })}
        onChange={onChange}
      />
    </label>
  );
}
