import type { Page } from "../app/page";
import { asksForUnit } from "../app/unit_question";
import { formatSize, type Unit } from "../app/units";
import { isKeyOfUpload } from "../app/upload";
import { sidesOf } from "./status_bar";
import { Button } from "./ui/button";

const offered: readonly { unit: Unit; label: string }[] = [
  { unit: "mm", label: "mm" },
  { unit: "cm", label: "cm" },
  { unit: "m", label: "m" },
  { unit: "in", label: "in" },
  { unit: "none", label: "No unit" },
];

/** Asks once for the unit of a dropped file, or of the models in a folder, whose files name none. */
export function UnitQuestion({ page }: { page: Page }) {
  const { view, state, box } = page.editor;
  if (state.value === null || box.value === null || !asksForUnit(view, state.value)) return null;
  return (
    <section class="unit-question" aria-label="Unit of the model">
      <p>
        The file names no unit. The model measures <strong>{formatSize(sidesOf(box.value), "none")}</strong> – of which?
      </p>
      <div class="buttons">
        {offered.map(({ unit, label }) => (
          <Button key={unit} label={label} onClick={() => view.chooseUnit(unit)} />
        ))}
      </div>
      <p class="hint">
        {isKeyOfUpload(view.folder.value) ? "This is remembered for this file." : "This counts for all such files of its folder."} You
        can change it under View.
      </p>
    </section>
  );
}
