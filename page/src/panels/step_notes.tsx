import type { Page } from "../app/page";
import { noteWords } from "../app/wording";
import { RemedyButton } from "./remedy_button";
import type { Step } from "./step_details";

/** Lists the engine's notes on the result of a step. */
export function StepNotes({ page, notes = [] }: { page: Page; notes: NonNullable<Step["found"]>["notes"] }) {
  return (
    <>
      {notes.map((note) => (
        <p key={noteWords(note)} class="hint">
          {noteWords(note)} <RemedyButton page={page} fact={note} />
        </p>
      ))}
    </>
  );
}
