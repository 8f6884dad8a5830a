import type { DocumentState } from "../../protocol";
import { stepTitle } from "../step_words";
import { counted } from "../units";
import { inPanelWords, type Failure, type Told } from "../wording";

/** Says what happens to the steps after a graft that is edited again. */
export function setAsideWords(count: number): string {
  const [are, run] = count === 1 ? ["is", "it"] : ["are", "them"];
  return `${counted(count, "later step")} ${are} set aside while you edit the graft. Accept runs ${run} on the new result, Cancel brings everything back.`;
}

/** Returns what to tell if a graft is not accepted because a step after it no longer applies. */
export function laterStepWords(failure: Failure, state: DocumentState | null): Told | undefined {
  if (!("id" in failure) || failure.step === undefined || state === null) return undefined;
  const later = state.graft?.set_aside[failure.step - state.steps.length];
  if (later === undefined) return undefined;
  const { problem, remedy } = inPanelWords({ ...failure, notes: [] });
  return {
    problem: `“${stepTitle(later, failure.step, false)}” no longer applies to the edited graft: ${problem}`,
    location: "",
    remedy: `Edit the graft further, or cancel it, which brings everything back. ${remedy}`.trim(),
  };
}
