import { Fragment } from "preact";
import type { Finding } from "../app/mending";
import type { Page } from "../app/page";
import { sentence, toldOfNote } from "../app/wording";
import { Button } from "./ui/button";
import { Section } from "./ui/section";

/** The defects of the model and, for grafting, of the parts: where they are, and a repair of each kind or of all. */
export function DefectsPanel({ page }: { page: Page }) {
  const { mending, graft, state } = page.editor;
  const model = state.value?.model.name;
  const objects = mending.defective.value.filter(({ name }) => name === model || graft.mode.value === "graft");
  if (objects.length === 0) return null;
  const kinds = objects.flatMap(({ findings }) => findings);
  return (
    <Section title="Defects" hint="They can disturb editing and printing. Mending is a step that undo takes back." badge={kinds.length} startsOpen>
      {objects.map(({ name, findings }) => (
        <Fragment key={name}>
          {name !== model && <p class="explained">{name}</p>}
          <ul class="list defects" aria-label={`Defects of ${name}`}>
            {findings.map((finding) => (
              <DefectRow key={finding.kind} page={page} object={name} finding={finding} />
            ))}
          </ul>
        </Fragment>
      ))}
      {kinds.some(({ repairable }) => repairable) && (
        <Button
          label="Mend all"
          icon="mend"
          kind="primary"
          tip="Also joins open seams and closes small holes."
          disabled={!mending.canMend.value}
          onClick={() => void mending.mendAll(objects.map(({ name }) => name))}
        />
      )}
      {!mending.canMend.value && <p class="hint">Accept or cancel the graft to mend.</p>}
    </Section>
  );
}

function DefectRow({ page, object, finding }: { page: Page; object: string; finding: Finding }) {
  const { mending } = page.editor;
  const { kind, note, repairable } = finding;
  const { problem, remedy } = toldOfNote(note);
  const isShown = mending.isMarked(object, kind);
  return (
    <li data-kind={kind}>
      <span class="defect-words">{sentence(problem)}</span>
      <Button
        label={isShown ? "Hide" : "Show"}
        kind="quiet"
        tip={isShown ? "Lights them up no longer." : "Lights them up and goes there."}
        onClick={() => void mending.toggle(object, kind)}
      />
      {repairable ? (
        <Button label="Mend" disabled={!mending.canMend.value} onClick={() => void mending.mend(object, [kind])} />
      ) : (
        <span class="explained">{remedy}</span>
      )}
    </li>
  );
}
