import { Fragment } from "preact";
import { useState } from "preact/hooks";
import type { Page } from "../app/page";
import { stepTitle } from "../app/step_words";
import { counted } from "../app/units";
import { CommandLabelButton } from "./command_button";
import { RepairDetails } from "./repair_details";
import { CutDetails, DeformDetails, GraftDetails, type DetailsProps, type Step } from "./step_details";
import { SculptDetails } from "./sculpt_details";
import { TransformDetails } from "./transform_details";
import { NameField } from "./ui/fields";
import { Icon, type IconName } from "./ui/icon";
import { Menu } from "./ui/menu";
import { Section } from "./ui/section";

const icons: Record<Step["kind"], IconName> = {
  deform: "handle",
  merge: "connected",
  cut: "minus",
  repair: "mend",
  sculpt: "brush",
  transform: "measure",
};

/**
 * The steps applied to the model, in order. The last one is being edited. Earlier ones can be changed, and the later
 * ones are then recomputed.
 */
export function StepsPanel({ page }: { page: Page }) {
  const state = page.editor.state.value;
  const steps = state?.steps ?? [];
  const setAside = state?.graft?.set_aside ?? [];
  const [open, setOpen] = useState<number | null>(null);
  return (
    <Section
      title="Steps"
      hint="The steps applied to the model, in order. Click an earlier one to change it; the later ones are recomputed."
      badge={steps.length + setAside.length}
    >
      {steps.length === 0 && <p class="hint">Paint a handle, or graft a part, to begin the first step.</p>}
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
              <li class="step-item" ref={bringIntoView}>
                <StepDetails page={page} step={step} index={i} />
              </li>
            )}
          </Fragment>
        ))}
        {setAside.map((step, i) => (
          <li key={`aside ${i}`} class="set-aside">
            <span class="list-main">
              <span class="swatch">
                <Icon name={icons[step.kind]} size={16} />
              </span>
              <span class="list-name">{stepTitle(step, steps.length + i, false)}</span>
              <small>set aside</small>
            </span>
          </li>
        ))}
      </ol>
      <CommandLabelButton page={page} id="accept" icon="accept" />
    </Section>
  );
}

function bringIntoView(item: HTMLElement | null): void {
  item?.scrollIntoView({ block: "nearest" });
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
  const title = stepTitle(step, index, editor.state.value?.parts.length === 0);
  const handles = step.kind === "deform" ? counted(step.handles, "handle") : "";
  const main = (
    <>
      <span class="swatch">
        <Icon name={icons[step.kind]} size={16} />
      </span>
      <span class="list-name">{title}</span>
      <small>{[handles, inWork ? "editing" : ""].filter((part) => part !== "").join(", ")}</small>
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

/** The fields of an earlier step that can be changed. */
function StepDetails(props: DetailsProps) {
  if (props.step.kind === "merge") return <GraftDetails {...props} />;
  if (props.step.kind === "cut") return <CutDetails {...props} />;
  if (props.step.kind === "repair") return <RepairDetails {...props} />;
  if (props.step.kind === "sculpt") return <SculptDetails {...props} />;
  if (props.step.kind === "transform") return <TransformDetails {...props} />;
  return <DeformDetails {...props} />;
}
