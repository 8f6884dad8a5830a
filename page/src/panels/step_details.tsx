import { numbersOf, withNumbers, type PoseNumbers } from "../app/handle_pose";
import { applicable, choiceOf, methodOf, methods, numberOf, type Settings } from "../app/method_settings";
import { commandOf, type Page } from "../app/page";
import { readStep, type GraftFields } from "../app/graft/graft_step";
import { latestGraft } from "../app/graft/mirror_latest";
import { closingFields, closingOf, isHalf, type Pins } from "../app/cuts";
import { formatNumber } from "../app/units";
import type { DocumentState, Plane, Pose, Vector } from "../protocol";
import { CommandLabelButton } from "./command_button";
import { CutClosingFields } from "./graft/cut_closing";
import { BlendColours, GraftNumbers, LoopToggles, MirrorField, ShapeField } from "./graft/graft_fields";
import { PoseNumberFields, Triple } from "./pose_fields";
import { StepNotes } from "./step_notes";
import { Button } from "./ui/button";
import { degrees, Segments, Select, Slider } from "./ui/fields";
import { More } from "./ui/section";

export type Step = DocumentState["steps"][number];

export interface DetailsProps {
  page: Page;
  step: Step;
  index: number;
}

/** The fields of a deform step: its method, the method's main settings, and its poses. */
export function DeformDetails({ page, step, index }: DetailsProps) {
  const { editor } = page;
  const fields = step.fields as { settings?: Settings; handles?: unknown };
  const settings = fields.settings ?? {};
  const change = (changes: Record<string, number | string>) =>
    void editor.ask({ do: "step", what: "change", index, fields: { settings: changes } });
  return (
    <div class="step-details">
      <Select
        label="Method"
        value={methodOf(settings)}
        choices={methods}
        onChange={(method) => change({ method })}
      />
      {applicable(settings)
        .filter(({ group, more }) => group === "shape" && more !== true)
        .map((setting) => {
          if (setting.kind === "number")
            return (
              <Slider
                {...setting}
                key={setting.key}
                value={numberOf(settings, setting)}
                onChange={(value) => change({ [setting.key]: value })}
              />
            );
          if (setting.kind === "choice")
            return (
              <Select
                key={setting.key}
                label={setting.label}
                choices={setting.choices}
                value={choiceOf(settings, setting)}
                onChange={(value) => change({ [setting.key]: value })}
              />
            );
          return null;
        })}
      {handlesIn(fields.handles).map(({ name, pose }) => (
        <StepPose
          key={name}
          name={name}
          pose={pose}
          page={page}
          onChange={(next) => void editor.ask({ do: "step", what: "change", index, poses: { [name]: next } })}
        />
      ))}
    </div>
  );
}

function handlesIn(list: unknown): { name: string; pose: Pose }[] {
  if (!Array.isArray(list)) return [];
  return list.map((handle: { name: string; pose?: Pose }) => ({
    name: handle.name,
    pose: handle.pose ?? {},
  }));
}

export interface StepPoseProps {
  page: Page;
  name: string;
  pose: Pose;
  onChange: (pose: Pose) => void;
}

/** The numbers of a pose. */
export function StepPose({ page, name, pose, onChange }: StepPoseProps) {
  const rest: Vector = pose.pivot ?? [0, 0, 0];
  const numbers = numbersOf(pose, rest);
  return (
    <fieldset>
      <legend>{name}</legend>
      {numbers === undefined ? (
        <p class="hint">
          {pose.matrix === undefined
            ? "A redrawn curve."
            : `A matrix; it translates by ${pose.matrix
                .slice(0, 3)
                .map((row) => formatNumber(row[3], 3))
                .join(", ")}.`}
        </p>
      ) : (
        <PoseNumberFields
          page={page}
          numbers={numbers}
          withPivot={pose.pivot !== undefined}
          change={(changes: Partial<PoseNumbers>) => onChange(withNumbers(pose, changes))}
        />
      )}
    </fieldset>
  );
}

/** The fields of a graft: all numbers and choices of the graft panel. Loops can be paired only in that panel. */
export function GraftDetails({ page, step: { fields, found }, index }: DetailsProps) {
  const step = readStep(fields);
  const keep = (changes: GraftFields) =>
    page.editor.ask({ do: "step", what: "change", index, fields: { ...changes } });
  const mesh = page.editor.graft.byName(step.source)?.mesh ?? -1;
  return (
    <div class="step-details">
      <GraftNumbers
        step={step}
        foundSize={found?.size}
        foundBase={found?.base_height}
        keep={keep}
        twist={<Twists page={page} count={found?.starts?.length ?? 0} index={index} />}
      />
      <ShapeField step={step} keep={keep} />
      <MirrorField step={step} keep={keep} middle={() => page.graft.centreOf(mesh)} />
      <EditAgain page={page} index={index} />
      {commandOf(page, "select-seam").enabled() && <CommandLabelButton page={page} id="select-seam" icon="loop" />}
      {commandOf(page, "relax-seam").enabled() && <CommandLabelButton page={page} id="relax-seam" icon="brush" />}
      {latestGraft(page.editor.state.value)?.fields === fields && <CommandLabelButton page={page} id="mirror-graft" icon="symmetry" />}
      <More label="More options">
        <BlendColours page={page} step={step} keep={keep} />
        <LoopToggles step={step} keep={keep} />
      </More>
    </div>
  );
}

/** Takes up an accepted graft again: pairs, matches, placement and fixed areas are in its panel. */
function EditAgain({ page, index }: Pick<DetailsProps, "page" | "index">) {
  const { editor } = page;
  if (editor.state.value?.graft !== null)
    return <p class="hint">To change pairs, placement or fixed areas, accept or cancel the other graft first.</p>;
  return (
    <Button
      label="Edit pairs and placement…"
      icon="connected"
      tip="Takes up the graft again, with its pairs, rotations, placement and fixed areas. Later steps are set aside meanwhile."
      onClick={() => void editor.ask({ do: "graft", what: "resume", step: index })}
    />
  );
}

interface TwistsProps {
  page: Page;
  count: number;
  index: number;
}

function Twists({ page, count, index }: TwistsProps) {
  const twist = (pair: number, by_deg: number) => {
    if (by_deg !== 0) void page.editor.ask({ do: "step", what: "change", index, twist: { pair, by_deg } });
  };
  return (
    <>
      {Array.from({ length: count }, (_, pair) => (
        <Slider
          key={pair}
          label={count > 1 ? `Twist pair ${pair + 1} by` : "Twist by"}
          {...degrees}
          step={5}
          value={0}
          help="Rotates the part along its loop, relative to now."
          onChange={(value) => twist(pair, value)}
        />
      ))}
    </>
  );
}

type Keep = "above" | "below" | "both";

/** The fields of a cut: its plane, if it has one, and the side that is kept. */
export function CutDetails({ page, step, index }: DetailsProps) {
  const fields = step.fields as { mesh?: string; plane?: Plane; keep?: Keep; snap?: number; cap?: string; pins?: Pins };
  const change = (changes: { plane?: Plane; keep?: Keep; snap?: number; cap?: "flat" | null; pins?: Pins | null }) =>
    void page.editor.ask({ do: "step", what: "change", index, fields: changes });
  const { plane } = fields;
  const divides = isHalf(page.editor.state.value?.steps ?? [], index);
  const unit = page.editor.view.unit.value;
  return (
    <div class="step-details">
      <Segments
        label="Keep"
        value={fields.keep ?? "both"}
        choices={[
          { value: "above", label: plane === undefined ? "Inside" : "Above", help: aboveHelp(plane) },
          { value: "below", label: plane === undefined ? "Outside" : "Below" },
          ...(divides ? [] : [{ value: "both", label: "Both", help: "Splits the mesh and keeps both sides." } as const]),
        ]}
        onChange={(keep) => change({ keep })}
      />
      {plane !== undefined && (
        <>
          <Triple
            label="Point"
            tip="A point of the plane."
            quantity="length"
            unit={unit}
            suffix={unit === "none" ? "" : unit}
            step={0.01 * (page.editor.state.value?.model.diagonal ?? 1)}
            value={plane.point}
            onChange={(point) => change({ plane: { ...plane, point } })}
          />
          <Triple
            label="Normal"
            tip="Points to the side above. Its length does not matter."
            quantity="number"
            step={0.1}
            value={plane.normal}
            onChange={(normal) => normal.some((n) => n !== 0) && change({ plane: { ...plane, normal } })}
          />
        </>
      )}
      {plane !== undefined && (
        <CutClosingFields
          closing={closingOf(fields)}
          unit={unit}
          diagonal={page.editor.state.value?.model.diagonal ?? 1}
          onChange={(closing) => change({ cap: null, pins: null, ...closingFields(closing) })}
        />
      )}
      <StepNotes page={page} notes={step.found?.notes} />
      <Slider
        label="Snap"
        min={0}
        max={0.5}
        step={0.05}
        digits={2}
        value={fields.snap ?? 0.1}
        help="Where the cut passes an end of an edge within this share of the edge's length, it goes through the vertex. Avoids slivers."
        onChange={(snap) => change({ snap })}
      />
    </div>
  );
}

function aboveHelp(plane: Plane | undefined): string {
  return plane === undefined ? "The side to the left of the curve." : "The side where the normal points: blue.";
}
