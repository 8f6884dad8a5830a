import type { Page } from "../app/page";
import { counted } from "../app/units";
import type { DocumentState } from "../protocol";
import { CommandLabelButton } from "./command_button";
import { Icon, type IconName } from "./ui/icon";
import { Section } from "./ui/section";

type Step = DocumentState["steps"][number];

const kinds: Record<Step["kind"], { name: string; icon: IconName }> = {
  deform: { name: "Deform", icon: "handle" },
  merge: { name: "Graft", icon: "connected" },
  cut: { name: "Cut", icon: "minus" },
};

/** What is done to the model, in order. The last one is in work. */
export function StepsPanel({ page }: { page: Page }) {
  const steps = page.editor.state.value?.steps ?? [];
  return (
    <Section title="Steps" hint="What is done to the model, in order. Accept the one in work to begin the next on its shape." badge={steps.length}>
      <ol class="list steps" aria-label="Steps">
        {steps.map((step, i) => (
          <li key={i} class={i === steps.length - 1 ? "active" : ""} aria-current={i === steps.length - 1 ? "step" : undefined}>
            <span class="list-main">
              <span class="swatch">
                <Icon name={kinds[step.kind].icon} size={16} />
              </span>
              <span class="list-name">{step.name ?? `${i + 1}. ${kinds[step.kind].name}`}</span>
              <small>{detailOf(step, i === steps.length - 1)}</small>
            </span>
          </li>
        ))}
      </ol>
      <CommandLabelButton page={page} id="accept" icon="accept" />
    </Section>
  );
}

function detailOf(step: Step, last: boolean): string {
  const handles = step.kind === "deform" ? counted(step.handles, "handle") : "";
  return [handles, last ? "in work" : ""].filter((part) => part !== "").join(", ");
}
