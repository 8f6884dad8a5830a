import type { ComponentChildren } from "preact";
import type { Page } from "../../app/page";
import type { GraftFields, GraftStep, Vector3Tuple } from "../../app/graft/graft_step";
import { IconButton } from "../ui/button";
import { degrees, Segments, Select, Slider, Toggle } from "../ui/fields";

/** The data needed to change a graft, the current one or that of an earlier step. */
export interface GraftFieldsProps {
  step: GraftStep;
  /** Commits fields; null removes a field. */
  keep: (fields: GraftFields) => unknown;
}

interface NumbersProps extends GraftFieldsProps {
  /** The scale that the engine found, if known. */
  foundSize: number | undefined;
  /** The height at which the engine cut a closed part open, if it did. */
  foundBase?: number | undefined;
  /** Previews fields while a slider is dragged. */
  drag?: (fields: GraftFields) => void;
  /** The field for the twist of paired loops. */
  twist: ComponentChildren;
}

/** The fields for normal angle, spin and size. */
export function GraftNumbers({ step, foundSize, foundBase, drag, keep, twist }: NumbersProps) {
  return (
    <>
      <Slider
        label="Tilt"
        {...degrees}
        softMin={-90}
        softMax={90}
        step={5}
        value={step.normalAngleDeg}
        help="The angle at which the part leaves the surface."
        onInput={(value) => drag?.({ normal_angle_deg: value })}
        onChange={(value) => keep({ normal_angle_deg: value === 0 ? null : value })}
      />
      {step.at === undefined ? twist : <Spin step={step} drag={drag} keep={keep} />}
      {step.at !== undefined && (foundBase ?? step.at.base?.height) !== undefined && (
        <>
          <BaseHeight step={step} found={foundBase ?? step.at.base!.height!} drag={drag} keep={keep} />
          <BaseTilt step={step} drag={drag} keep={keep} />
        </>
      )}
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
                ? "Found from the loops. Drag to set it yourself."
                : "The scale of the part, set by you."
            }
            onInput={(value) => drag?.({ size: value })}
            onChange={(value) => keep({ size: value })}
          />
          {step.size !== undefined && (
            <IconButton label="Reset size" icon="reset" onClick={() => keep({ size: null })} />
          )}
        </div>
      )}
    </>
  );
}

function Spin({ step, drag, keep }: Omit<NumbersProps, "foundSize" | "foundBase" | "twist">) {
  const at = (spin_deg: number): GraftFields => ({ at: { ...step.at, spin_deg } });
  return (
    <Slider
      label="Spin"
      {...degrees}
      step={15}
      value={step.at?.spin_deg ?? 0}
      help="Rotates the part about the surface's normal."
      onInput={(value) => drag?.(at(value))}
      onChange={(value) => keep(at(value))}
    />
  );
}

function BaseHeight({ step, found, drag, keep }: Omit<NumbersProps, "foundSize" | "foundBase" | "twist"> & { found: number }) {
  const { base, ...place } = step.at ?? {};
  const at = (height: number): GraftFields => ({ at: { ...place, base: { ...base, height } } as GraftFields["at"] });
  return (
    <div class="size-row">
      <Slider
        label="Base"
        min={-Infinity}
        above={0}
        max={1e12}
        softMin={found / 4}
        softMax={found * 4}
        logarithmic
        step={0.05}
        digits={3}
        value={base?.height ?? found}
        help="The part is closed: where it is cut open, above its lowest point."
        onInput={(height) => drag?.(at(height))}
        onChange={(height) => keep(at(height))}
      />
      {base?.height !== undefined && (
        <IconButton label="Reset base" icon="reset" onClick={() => keep({ at: place as GraftFields["at"] })} />
      )}
    </div>
  );
}

/** The tilt of the plane at which a closed part is cut open. */
function BaseTilt({ step, drag, keep }: Omit<NumbersProps, "foundSize" | "foundBase" | "twist">) {
  const { base, ...place } = step.at ?? {};
  const at = (tilt_deg: number): GraftFields => ({ at: { ...place, base: { ...base, tilt_deg } } as GraftFields["at"] });
  return (
    <Slider
      label="Base tilt"
      {...degrees}
      min={-90}
      max={90}
      softMin={-60}
      softMax={60}
      step={5}
      value={base?.tilt_deg ?? 0}
      help="The part is closed: tilts the plane at which it is cut open, about the x axis of the part unless the step names another axis; the grip at the rim of the outline points the way."
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
      help="The part keeps its shape away from the seam, or all of it bends to fit the loops (linear, as in the paper)."
      choices={[
        { value: "similar", label: "Keep" },
        { value: "ft05", label: "Bend" },
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
      help="Mirrors the part first. A left hand becomes a right one."
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

/** The length within which the vertex colours of part and model mix. */
export function BlendColours({ page, step, keep }: GraftFieldsProps & { page: Page }) {
  const diagonal = page.editor.state.value?.model.diagonal ?? 1;
  const unit = page.editor.view.unit.value;
  return (
    <Slider
      label="Blending"
      value={step.blendColours}
      min={0}
      max={1e6 * diagonal}
      softMin={0}
      softMax={0.3 * diagonal}
      quantity="length"
      unit={unit}
      suffix={unit === "none" ? "" : unit}
      step={0.01 * diagonal}
      digits={3}
      help="How far from the seam the vertex colours of part and model mix."
      onChange={(length) => keep({ settings: { ...step.settings, blend_colours: length } })}
    />
  );
}

export function LoopToggles({ step, keep }: GraftFieldsProps) {
  return (
    <>
      <Toggle
        label="Smooth ragged loops"
        value={step.smoothBoundary}
        help="Smooths frayed boundaries before they are matched."
        onChange={(on) => keep({ smooth_boundary: on || null })}
      />
      <Toggle
        label="Flip normals of part"
        value={step.fixWinding}
        help="For a part whose normals point inward."
        onChange={(on) => keep({ fix_winding: on || null })}
      />
      <Toggle
        label="Retry a faulty seam"
        value={step.retry}
        help="Where faces at the seam fold over or intersect, other angles, sizes and rotations are tried."
        onChange={(on) => keep({ retry: on ? null : false })}
      />
    </>
  );
}
