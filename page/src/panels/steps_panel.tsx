import { Fragment } from "preact";
import { useState } from "preact/hooks";
import { numbersOf, withNumbers, type PoseNumbers } from "../app/handle_pose";
import { applicable, choiceOf, methodOf, methods, numberOf, type Settings } from "../app/method_settings";
import type { Page } from "../app/page";
import { counted, formatNumber } from "../app/units";
import type { DocumentState, Pose, Vector } from "../protocol";
import { CommandLabelButton } from "./command_button";
import { PoseNumberFields } from "./pose_fields";
import { NameField, Select, Slider } from "./ui/fields";
import { Icon, type IconName } from "./ui/icon";
import { Menu } from "./ui/menu";
import { Section } from "./ui/section";

type Step = DocumentState["steps"][number];

const kinds: Record<Step["kind"], { name: string; icon: IconName }> = {
  deform: { name: "Deform", icon: "handle" },
  merge: { name: "Graft", icon: "connected" },
  cut: { name: "Cut", icon: "minus" },
};

/** What is done to the model, in order. The last one is in work; earlier ones can be changed, and the rest follows. */
export function StepsPanel({ page }: { page: Page }) {
  const state = page.editor.state.value;
  const steps = state?.steps ?? [];
  const [open, setOpen] = useState<number | null>(null);
  return (
    <Section
      title="Steps"
      hint="What is done to the model, in order. An earlier one can be changed; the later ones follow."
      badge={steps.length}
    >
      <ol class="list steps" aria-label="Steps">
        {steps.map((step, i) => (
          <Fragment key={i}>
            <StepRow
              page={page}
              step={step}
              index={i}
              inWork={i === steps.length - 1}
              open={open === i}
              onOpen={() => setOpen(open === i ? null : i)}
            />
            {open === i && i < steps.length - 1 && (
              <li class="step-item">
                <StepDetails page={page} step={step} index={i} />
              </li>
            )}
          </Fragment>
        ))}
      </ol>
      <CommandLabelButton page={page} id="accept" icon="accept" />
    </Section>
  );
}

interface RowProps {
  page: Page;
  step: Step;
  index: number;
  inWork: boolean;
  open: boolean;
  onOpen: () => void;
}

function StepRow({ page, step, index, inWork, open, onOpen }: RowProps) {
  const { editor } = page;
  const [renames, setRenames] = useState(false);
  const title = step.name ?? `${index + 1}. ${kinds[step.kind].name}`;
  const handles = step.kind === "deform" ? counted(step.handles, "handle") : "";
  const main = (
    <>
      <span class="swatch">
        <Icon name={kinds[step.kind].icon} size={16} />
      </span>
      <span class="list-name">{title}</span>
      <small>{[handles, inWork ? "in work" : ""].filter((part) => part !== "").join(", ")}</small>
    </>
  );
  const rename = (name: string) => void editor.ask({ do: "step", what: "rename", index, name });
  return (
    <li class={inWork ? "active" : ""} aria-current={inWork ? "step" : undefined}>
      {renames && <NameField name={step.name ?? title} onRename={rename} onEnd={() => setRenames(false)} />}
      {!renames && inWork && <span class="list-main">{main}</span>}
      {!renames && !inWork && (
        <button type="button" class="list-main" aria-expanded={open} onClick={onOpen}>
          {main}
        </button>
      )}
      <Menu
        label={`More for ${title}`}
        items={[
          { label: "Rename", icon: "rename", run: () => setRenames(true) },
          {
            label: "Remove",
            icon: "remove",
            danger: true,
            begins: true,
            run: () => void editor.ask({ do: "step", what: "remove", index }),
          },
        ]}
      />
    </li>
  );
}

interface DetailsProps {
  page: Page;
  step: Step;
  index: number;
}

/** What of an earlier deform step can be changed here: its method, what that has most use for, and its poses. */
function StepDetails({ page, step, index }: DetailsProps) {
  const { editor } = page;
  const fields = step.fields as { settings?: Settings; handles?: unknown };
  if (step.kind !== "deform")
    return <p class="hint">This step is changed where it was made; here it can be renamed or removed.</p>;
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

interface StepPoseProps {
  page: Page;
  name: string;
  pose: Pose;
  onChange: (pose: Pose) => void;
}

function StepPose({ page, name, pose, onChange }: StepPoseProps) {
  const rest: Vector = pose.pivot ?? [0, 0, 0];
  const numbers = numbersOf(pose, rest);
  return (
    <fieldset>
      <legend>{name}</legend>
      {numbers === undefined ? (
        <p class="hint">
          {pose.matrix === undefined
            ? "A redrawn curve."
            : `A matrix with the shift ${pose.matrix
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
