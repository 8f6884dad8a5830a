import { useLayoutEffect, useRef } from "preact/hooks";
import type { Page } from "../app/page";
import { printLines, type PrintFinding, type PrintLine, type PrintRemedy } from "../app/print_words";
import { CommandLabelButton } from "./command_button";
import { Button } from "./ui/button";
import { NumberField, Select } from "./ui/fields";
import { Icon, type IconName } from "./ui/icon";
import { Section } from "./ui/section";

const icons: Record<PrintLine["tone"], IconName> = { good: "accept", bad: "warning", warning: "warning", fact: "note" };

/** The check before printing, and the tools that give the model its size and place. */
export function PrintPanel({ page }: { page: Page }) {
  const { printing, view } = page.editor;
  const unit = view.unit.value;
  const check = printing.result.value;
  const list = useRef<HTMLUListElement>(null);
  const asked = useRef(false);
  useLayoutEffect(() => {
    if (asked.current && check !== null) list.current?.scrollIntoView({ block: "nearest" });
    asked.current = false;
  }, [check]);
  const limits = { leastWall: printing.leastWall.value, overhangDeg: printing.overhangDeg.value, unit };
  return (
    <Section title="Print" hint="Checks the edited model or a part before you print it, and gives it its size and place.">
      <div class="buttons">
        <CommandLabelButton page={page} id="tool-measure" icon="measure" />
        <CommandLabelButton page={page} id="tool-flat" icon="flat" />
      </div>
      <CheckedObject page={page} />
      <label class="row">
        <span id="least-wall">Least wall</span>
        <NumberField
          label="Least wall"
          labelledBy="least-wall"
          value={limits.leastWall}
          quantity="length"
          unit={unit}
          suffix={unit === "none" ? "" : unit}
          min={0}
          step={0.1}
          tip="The thinnest that can be printed. Many printers need about 1 mm."
          onChange={(least) => {
            printing.leastWall.value = least;
            void printing.renew();
          }}
        />
      </label>
      <label class="row">
        <span id="overhang">Overhang</span>
        <NumberField
          label="Overhang"
          labelledBy="overhang"
          value={limits.overhangDeg}
          quantity="angle"
          suffix="°"
          min={0}
          max={90}
          step={5}
          tip="The largest that prints without supports, from the vertical: 0° is a wall, 90° a ceiling."
          onChange={(angle) => {
            printing.overhangDeg.value = angle;
            void printing.renew();
          }}
        />
      </label>
      <Button
        label={check === null ? "Check" : "Check again"}
        kind={check === null ? "primary" : "plain"}
        onClick={() => {
          asked.current = true;
          void printing.check();
        }}
      />
      {check === null && <p class="hint">Nothing is checked yet. Check finds holes, thin walls, overhangs and more, and shows where they are.</p>}
      {check !== null && (
        <ul ref={list} class="list defects" aria-label="Print check">
          {printLines(check, limits).map((line) => (
            <PrintRow key={line.words} page={page} line={line} />
          ))}
        </ul>
      )}
    </Section>
  );
}

/** Chooses which object is checked, if there are parts. */
function CheckedObject({ page }: { page: Page }) {
  const { printing, state } = page.editor;
  const { model, parts } = state.value ?? {};
  if (model === undefined || parts === undefined || parts.length === 0) return null;
  return (
    <Select
      label="Object"
      value={printing.checked()?.name ?? ""}
      choices={[
        { value: "", label: `${model.name} (the model)` },
        ...parts.map(({ name }) => ({ value: name, label: name })),
      ]}
      onChange={(name) => printing.choose(name)}
    />
  );
}

/** One line of a check, with where it is and a remedy. */
function PrintRow({ page, line: { tone, words, finding, remedy, advice } }: { page: Page; line: PrintLine }) {
  const { printing } = page.editor;
  const row = useRef<HTMLLIElement>(null);
  const isShown = finding !== undefined && printing.isMarked(finding);
  // A part is shown among the panels of grafts, which move this one.
  const toggle = async (finding: PrintFinding) => {
    await printing.toggle(finding);
    row.current?.scrollIntoView({ block: "nearest" });
  };
  return (
    <li ref={row} class={`print-${tone}`}>
      <Icon name={icons[tone]} size={14} />
      <span class="defect-words">
        {words}
        {advice !== undefined && <small>{advice}</small>}
      </span>
      {finding !== undefined && (
        <Button label={isShown ? "Hide" : "Show"} kind="quiet" onClick={() => void toggle(finding)} />
      )}
      {remedy !== undefined && <RemedyButton page={page} remedy={remedy} />}
    </li>
  );
}

function RemedyButton({ page, remedy }: { page: Page; remedy: PrintRemedy }) {
  const { mending, state, printing } = page.editor;
  const object = printing.checked() ?? state.value?.model;
  if (object === undefined) return null;
  const { name, findings } = object;
  const kinds = ({ split: ["non-manifold-edge"], turn: ["inconsistent-winding", "inward-facing-component"], "close-holes": [] } as const)[remedy];
  const meant = findings.map(({ kind }) => kind).filter((kind) => (kinds as readonly string[]).includes(kind));
  if (remedy !== "close-holes" && meant.length === 0) return null; // the step being edited made it
  return (
    <Button
      label={remedy === "close-holes" ? "Close" : "Mend"}
      disabled={!mending.canMend.value}
      tip={remedy === "close-holes" ? "Closes all holes smoothly. Undo takes it back." : ""}
      onClick={() => void (remedy === "close-holes" ? mending.closeHoles(name) : mending.mend(name, meant))}
    />
  );
}
