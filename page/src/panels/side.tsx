import type { Signal } from "@preact/signals";
import type { TargetedKeyboardEvent } from "preact";
import type { Page } from "../app/page";
import { noteWords } from "../app/wording";
import { DefectsPanel } from "./defects_panel";
import { GraftPanels } from "./graft/graft_panel";
import { GroupsPanel } from "./groups_panel";
import { HandlesPanel } from "./handles_panel";
import { MethodPanel } from "./method_panel";
import { PrintPanel } from "./print_panel";
import { StepsPanel } from "./steps_panel";
import { SymmetryPanel } from "./symmetry_panel";
import { RemedyButton } from "./remedy_button";
import { Button } from "./ui/button";
import { Section } from "./ui/section";
import { UnitQuestion } from "./unit_question";
import { ViewPanel } from "./view_panel";

export type Mode = "deform" | "graft";
export interface ModeTab {
  mode: Mode;
  label: string;
  tip: string;
}

const modes: readonly ModeTab[] = [
  { mode: "deform", label: "Deform", tip: "Move, turn and scale parts of the model." },
  { mode: "graft", label: "Graft", tip: "Join another model to this one, and cut." },
];

/** The panels at the right. */
export function Side({ page }: { page: Page }) {
  const { mode } = page.editor.graft;
  return (
    <aside class="side" aria-label="Panels">
      {modes.length > 1 && (
        <div class="modes" role="tablist" aria-label="What to do" onKeyDown={(event) => stepTabs(event, mode)}>
          {modes.map((tab) => (
            <button
              type="button"
              key={tab.mode}
              role="tab"
              data-mode={tab.mode}
              aria-selected={mode.value === tab.mode}
              tabIndex={mode.value === tab.mode ? 0 : -1}
              data-tip={tab.tip}
              onClick={() => (mode.value = tab.mode)}
            >
              {tab.label}
            </button>
          ))}
        </div>
      )}
      <UnitQuestion page={page} />
      <Notes page={page} />
      <div class="panels">
        <DefectsPanel page={page} />
        {mode.value === "deform" && <DeformPanels page={page} />}
        {mode.value === "graft" && <GraftPanels page={page} />}
        <StepsPanel page={page} />
        <PrintPanel page={page} />
        <ViewPanel page={page} />
      </div>
    </aside>
  );
}

function DeformPanels({ page }: { page: Page }) {
  if (page.editor.graft.isEdited.value)
    return (
      <>
        <GraftFirst page={page} />
        <GroupsPanel page={page} />
      </>
    );
  return (
    <>
      <HandlesPanel page={page} />
      <MethodPanel page={page} />
      <SymmetryPanel page={page} />
      <GroupsPanel page={page} />
    </>
  );
}

/** Takes the place of what deforms while a graft is edited. */
function GraftFirst({ page }: { page: Page }) {
  const { graft } = page.editor;
  return (
    <Section title="Deform" hint="Moves, turns and scales parts of the model." startsOpen>
      <div class="empty">
        <p>A graft is being edited. Accept or cancel it, then deform its result.</p>
        <Button label="Show the graft" kind="primary" onClick={() => (graft.mode.value = "graft")} />
      </div>
    </Section>
  );
}

/** Moves to the next or previous tab by the arrow keys. */
function stepTabs(event: TargetedKeyboardEvent<HTMLElement>, mode: Signal<Mode>): void {
  const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
  if (by === 0) return;
  event.preventDefault();
  const at = modes.findIndex((tab) => tab.mode === mode.value);
  const next = (at + by + modes.length) % modes.length;
  mode.value = modes[next]?.mode ?? mode.value;
  event.currentTarget.querySelectorAll<HTMLElement>('[role="tab"]')[next]?.focus();
}

/** Shows the notes of the step, which tell where the result differs from the request. */
function Notes({ page }: { page: Page }) {
  const notes = page.editor.state.value?.notes ?? [];
  if (notes.length === 0) return null;
  return (
    <ul class="notes" aria-label="Notes on this step">
      {notes.map((note) => (
        <li key={noteWords(note)}>
          {noteWords(note)} <RemedyButton page={page} fact={note} />
        </li>
      ))}
    </ul>
  );
}
