import type { ComponentChildren } from "preact";
import type { GraftFields, GraftStep, Vector3Tuple } from "../../app/graft/graft_step";
import { IconButton } from "../ui/button";
import { degrees, Segments, Select, Slider, Toggle } from "../ui/fields";

/** The data needed to change a graft, the current one or that of an earlier step. */
export interface GraftFieldsProps {
  step: GraftStep;
  /** Commits fields; null removes a field. */
  keep: (fields: GraftFields) => void;
}

interface NumbersProps extends GraftFieldsProps {
  /** The scale that the engine found, if known. */
  foundSize: number | undefined;
  /** Previews fields while a slider is dragged. */
  drag?: (fields: GraftFields) => void;
  /** The field for the twist of paired loops. */
  twist: ComponentChildren;
}

/** The fields for normal angle, spin and size. */
export function GraftNumbers({ step, foundSize, drag, keep, twist }: NumbersProps) {
  return (
    <>
      <Slider
        label="Normal angle"
        {...degrees}
        softMin={-90}
        softMax={90}
        step={5}
        value={step.normalAngleDeg}
        help="Turns the way the part leaves the surface, about the loop."
        onInput={(value) => drag?.({ normal_angle_deg: value })}
        onChange={(value) => keep({ normal_angle_deg: value === 0 ? null : value })}
      />
      {step.at === undefined ? twist : <Spin step={step} drag={drag} keep={keep} />}
      {(step.pose === "find" || step.at !== undefined) && (
        <div class="size-row">
          <Slider
            label="Size"
            min={-Infinity}
            above={0}
            max={1e6}
            softMin={0.1}
            softMax={10}
            logarithmic
            suffix="×"
            step={0.05}
            digits={3}
            value={step.size ?? foundSize ?? 1}
            help={
              step.size === undefined
                ? "As the loops ask for. Drag to choose it."
                : "The part's scale, as you chose it."
            }
            onInput={(value) => drag?.({ size: value })}
            onChange={(value) => keep({ size: value })}
          />
          {step.size !== undefined && (
            <IconButton label="Size as the loops ask for" icon="reset" onClick={() => keep({ size: null })} />
          )}
        </div>
      )}
    </>
  );
}

function Spin({ step, drag, keep }: Omit<NumbersProps, "foundSize" | "twist">) {
  const at = (spin_deg: number): GraftFields => ({ at: { ...step.at, spin_deg } });
  return (
    <Slider
      label="Spin"
      {...degrees}
      step={15}
      value={step.at?.spin_deg ?? 0}
      help="Turns the part about the surface's normal."
      onInput={(value) => drag?.(at(value))}
      onChange={(value) => keep(at(value))}
    />
  );
}

export function ShapeField({ step, keep }: GraftFieldsProps) {
  return (
    <Segments
      label="Shape"
      value={step.shape}
      help="Away from the seam the part keeps its shape, or all of it bends with the loops (linear, as in the paper)."
      choices={[
        { value: "similar", label: "Keeps it" },
        { value: "ft05", label: "Bends" },
      ]}
      onChange={(shape) => keep({ shape })}
    />
  );
}

const axes = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] } as const;
type MirrorAxis = "none" | keyof typeof axes | "other";

/** The field for a mirrored part. `middle` returns the centre of the part, where the mirror plane goes. */
export function MirrorField({ step, keep, middle }: GraftFieldsProps & { middle: () => Vector3Tuple }) {
  const normal = step.mirror?.normal;
  const value: MirrorAxis =
    normal === undefined
      ? "none"
      : ((Object.keys(axes) as (keyof typeof axes)[]).find((axis) =>
          axes[axis].every((x, k) => Math.abs(Math.abs(normal[k] ?? 0) - x) < 1e-9),
        ) ?? "other");
  const mirror = (axis: MirrorAxis) => {
    if (axis === "none") keep({ mirror: null });
    else if (axis !== "other") keep({ mirror: { point: middle(), normal: [...axes[axis]] } });
  };
  return (
    <Select
      label="Mirror"
      value={value}
      help="Mirrors the part first: a left hand becomes a right one."
      choices={[
        { value: "none", label: "No" },
        { value: "x", label: "Across X" },
        { value: "y", label: "Across Y" },
        { value: "z", label: "Across Z" },
        ...(value === "other" ? [{ value: "other" as const, label: "Another plane" }] : []),
      ]}
      onChange={mirror}
    />
  );
}

export function LoopToggles({ step, keep }: GraftFieldsProps) {
  return (
    <>
      <Toggle
        label="Smooth ragged loops"
        value={step.smoothBoundary}
        help="Matches smoothed curves where a boundary is frayed."
        onChange={(on) => keep({ smooth_boundary: on || null })}
      />
      <Toggle
        label="Turn part inside out"
        value={step.fixWinding}
        help="For a part whose faces point inward."
        onChange={(on) => keep({ fix_winding: on || null })}
      />
    </>
  );
}
