import { noteWords } from "../app/wording";
import type { Step } from "./step_details";

/** Lists the engine's notes on the result of a step. */
export function StepNotes({ notes = [] }: { notes: NonNullable<Step["found"]>["notes"] }) {
  return (
    <>
      {notes.map(noteWords).map((words) => (
        <p key={words} class="hint">
          {words}
        </p>
      ))}
    </>
  );
}
