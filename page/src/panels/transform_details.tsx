import type { DetailsProps } from "./step_details";
import { StepPose } from "./step_details";
import type { Pose } from "../protocol";

/** The pose of a step that moves, turns and scales the whole model. */
export function TransformDetails({ page, step, index }: DetailsProps) {
  const { pose = {} } = step.fields as { pose?: Pose };
  return (
    <div class="step-details">
      <StepPose
        name="Whole model"
        pose={pose}
        page={page}
        onChange={(next) => void page.editor.ask({ do: "step", what: "change", index, fields: { pose: next } })}
      />
    </div>
  );
}
