import {
  axisOf,
  isAtRest,
  isUniform,
  nameOfAxis,
  numbersOf,
  withComponent,
  withNumbers,
  type AxisName,
  type PoseNumbers,
} from "../app/handle_pose";
import type { Page } from "../app/page";
import type { Unit } from "../app/units";
import type { Handle, Vector } from "../protocol";
import { Button } from "./ui/button";
import { NumberField, Segments } from "./ui/fields";
import { remembered } from "../app/remembered";

const axes = ["X", "Y", "Z"] as const;

/** The pose of a handle, in numbers. */
export function PoseFields({ page, handle }: { page: Page; handle: Handle }) {
  const { editor } = page;
  const { value: dragged } = editor.tools.dragged;
  const pose = dragged?.handle === handle.name ? dragged.pose : handle.pose;
  const numbers = numbersOf(pose, handle.pivot ?? handle.centre ?? [0, 0, 0]);
  const reset = (
    <Button
      label="Reset"
      icon="reset"
      kind="quiet"
      disabled={isAtRest(handle.pose)}
      tip="Returns the handle to where it was at the start of the step."
      onClick={() => void editor.pose({ [handle.name]: {} })}
    />
  );
  if (numbers === undefined) return <FreePose handle={handle} reset={reset} />;
  const change = (changes: Partial<PoseNumbers>) =>
    void editor.pose({ [handle.name]: withNumbers(handle.pose, changes) });
  return (
    <div class="pose">
      <PoseNumberFields page={page} numbers={numbers} change={change} withPivot />
      {reset}
    </div>
  );
}

interface NumberFieldsProps extends PartProps {
  page: Page;
  withPivot: boolean;
}

const farthestMove = 1e8; // × the diagonal of the model; scans may lie that far from the origin
const largestAngleDeg = 1e6; // what the engine accepts

/** The fields for translation, rotation, scale and pivot. */
export function PoseNumberFields({ page, numbers, change, withPivot }: NumberFieldsProps) {
  const { editor } = page;
  const unit = editor.view.unit.value;
  const diagonal = editor.state.value?.model.diagonal ?? 1;
  const lengths = {
    quantity: "length",
    unit,
    step: 0.01 * diagonal,
    suffix: unit === "none" ? "" : unit,
  } as const;
  return (
    <>
      <Triple
        label="Move"
        {...lengths}
        most={Number((farthestMove * diagonal).toPrecision(1))}
        value={numbers.translate}
        onChange={(translate) => change({ translate })}
      />
      <Turn numbers={numbers} change={change} />
      <Scale numbers={numbers} change={change} />
      {withPivot && (
        <Triple
          label="Pivot"
          tip="The point about which the handle rotates and scales. By default the centre of its boundary."
          {...lengths}
          value={numbers.pivot}
          onChange={(pivot) => change({ pivot })}
        />
      )}
    </>
  );
}

function FreePose({ handle, reset }: { handle: Handle; reset: preact.JSX.Element }) {
  const { matrix } = handle.pose;
  return (
    <div class="pose">
      <p class="hint">
        {matrix === undefined
          ? "This curve was redrawn point by point."
          : "This pose is a matrix: it shears, or came from a file. Reset it to enter numbers."}
      </p>
      {matrix !== undefined && (
        <table class="matrix" aria-label="Matrix of the pose">
          <tbody>
            {matrix.slice(0, 3).map((row, r) => (
              <tr key={r}>
                {row.map((value, c) => (
                  <td key={c}>{Number(value.toPrecision(4))}</td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {reset}
    </div>
  );
}

interface TripleProps {
  label: string;
  value: Vector;
  onChange: (value: Vector) => void;
  quantity: "length" | "factor" | "number";
  unit?: Unit;
  suffix?: string;
  step: number;
  above?: number;
  /** The largest number in either direction. */
  most?: number;
  tip?: string;
}

/** Three numbers, one for each axis. */
export function Triple({ label, value, onChange, quantity, unit, suffix, step, above, most, tip }: TripleProps) {
  return (
    <div class="triple" role="group" aria-label={label} data-tip={tip}>
      <span class="label">
        {label} {suffix !== undefined && suffix !== "" && <small>{suffix}</small>}
      </span>
      {([0, 1, 2] as const).map((k) => (
        <span class={`axis axis-${k}`} key={k}>
          <NumberField
            label={`${label} ${axes[k]}`}
            value={value[k]}
            quantity={quantity}
            unit={unit}
            step={step}
            decimals={Math.max(2, 2 - Math.floor(Math.log10(step)))}
            above={above}
            min={most === undefined ? undefined : -most}
            max={most}
            onChange={(to) => onChange(withComponent(value, k, to))}
          />
        </span>
      ))}
    </div>
  );
}

interface PartProps {
  numbers: PoseNumbers;
  change: (changes: Partial<PoseNumbers>) => void;
}

function Turn({ numbers: { axis, angleDeg }, change }: PartProps) {
  const name = nameOfAxis(axis);
  const turns = Math.abs(angleDeg) > 360 ? `${Number((angleDeg / 360).toFixed(2))} turns` : "";
  const choose = (to: AxisName) => change({ axis: to === "free" ? [1, 1, 0] : axisOf(to) });
  return (
    <>
      <div
        class="triple turn"
        role="group"
        aria-label="Rotate"
        data-tip="Rotates about an axis, also by more than 360°. You can type “2 turns”, too."
      >
        <span class="label">
          Rotate <small class={turns === "" ? "" : "turns"}>{turns === "" ? "°" : turns}</small>
        </span>
        <NumberField
          label="Rotation angle"
          value={angleDeg}
          quantity="angle"
          step={5}
          min={-largestAngleDeg}
          max={largestAngleDeg}
          digits={6}
          onChange={(to) => change({ angleDeg: to })}
        />
        <Segments
          label="Rotation axis"
          hideLabel
          value={name}
          choices={[
            { value: "x", label: "X" },
            { value: "y", label: "Y" },
            { value: "z", label: "Z" },
            { value: "free", label: "…", help: "Any axis" },
          ]}
          onChange={choose}
        />
      </div>
      {name === "free" && angleDeg !== 0 && (
        <Triple
          label="Axis"
          quantity="number"
          step={0.1}
          value={axis}
          onChange={(to) => to.some((a) => a !== 0) && change({ axis: to })}
        />
      )}
    </>
  );
}

function Scale({ numbers: { scale }, change }: PartProps) {
  const linked = remembered("scale linked", true);
  const together = linked.value && isUniform(scale);
  return (
    <div class="scale-row">
      {together ? (
        <div class="triple" role="group" aria-label="Scale">
          <span class="label">
            Scale <small>×</small>
          </span>
          <NumberField
            label="Scale"
            value={scale[0]}
            quantity="factor"
            step={0.05}
            above={0}
            onChange={(s) => change({ scale: [s, s, s] })}
          />
        </div>
      ) : (
        <Triple
          label="Scale"
          suffix="×"
          quantity="factor"
          step={0.05}
          above={0}
          value={scale}
          onChange={(to) => change({ scale: to })}
        />
      )}
      <label class="link" data-tip="Scales all axes equally.">
        <input
          type="checkbox"
          checked={together}
          onChange={(event) => {
            linked.value = event.currentTarget.checked;
            if (linked.value && !isUniform(scale)) change({ scale: [scale[0], scale[0], scale[0]] });
          }}
        />
        uniform
      </label>
    </div>
  );
}
