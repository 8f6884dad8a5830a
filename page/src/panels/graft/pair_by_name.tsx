import { useState } from "preact/hooks";
import type { LoopRef, MeshObject } from "../../app/graft/graft";
import { needsPair, pairsToGoWords } from "../../app/graft/graft_words";
import type { Page } from "../../app/page";
import { counted, formatNumber } from "../../app/units";
import { Button } from "../ui/button";
import { Select } from "../ui/fields";
import { More } from "../ui/section";

/** Pairs loops that are chosen by name. */
export function PairByName({ page }: { page: Page }) {
  const { graft } = page.editor;
  const parts = graft.isEdited.value
    ? [graft.source.value]
    : graft.parts.value.filter((part) => graft.isShown(part) && part.loops > 0);
  const [chosen, setChosen] = useState("");
  const part = parts.find((part) => part?.name === chosen) ?? parts[0];
  const target = graft.isEdited.value ? graft.target.value : graft.model.value;
  if (part === undefined || part.loops === 0 || target === undefined || target.loops === 0) return null;
  return (
    <div class="pair-by-name">
      <More label="Pair loops by name">
        {parts.length > 1 && (
          <Select
            label="Part"
            value={part.name}
            choices={parts.flatMap((part) => (part === undefined ? [] : [{ value: part.name, label: part.name }]))}
            onChange={setChosen}
          />
        )}
        <LoopsToPair key={`${part.mesh} ${target.mesh}`} page={page} part={part} target={target} />
      </More>
    </div>
  );
}

function LoopsToPair({ page, part, target }: { page: Page; part: MeshObject; target: MeshObject }) {
  const { editor } = page;
  const { graft } = editor;
  const [ofPart, setOfPart] = useState<number | undefined>(undefined);
  const [ofTarget, setOfTarget] = useState<number | undefined>(undefined);
  const pairs = graft.keptPairs.value;
  const free = (count: number, taken: readonly number[]) => Math.max(0, Array.from({ length: count }, (_, k) => k).findIndex((k) => !taken.includes(k)));
  const first = { mesh: part.mesh, loop: ofPart ?? free(part.loops, pairs.map(({ sourceLoop }) => sourceLoop)) };
  const second = { mesh: target.mesh, loop: ofTarget ?? free(target.loops, pairs.map(({ targetLoop }) => targetLoop)) };
  const others = pairs.filter((pair) => (pair.sourceLoop === first.loop) !== (pair.targetLoop === second.loop));
  const isPaired = pairs.some((pair) => pair.sourceLoop === first.loop && pair.targetLoop === second.loop);
  const pair = async () => {
    graft.hovered.value = null;
    setOfPart(undefined);
    setOfTarget(undefined);
    if (!(await graft.pair(first, second))) return; // a message says why
    const replaced = others.length === 0 ? "" : " Their earlier pairs are removed.";
    const more = needsPair(graft) ? ` ${pairsToGoWords(graft)}.` : "";
    editor.announce(
      `Loop ${first.loop + 1} of ${part.name} and loop ${second.loop + 1} of ${target.name} are paired.${replaced}${more}`,
    );
    focusAgain();
  };
  return (
    <>
      <LoopChoice page={page} of={part} chosen={first} paired={pairs.map((pair) => pair.sourceLoop)} onChange={setOfPart} />
      <LoopChoice page={page} of={target} chosen={second} paired={pairs.map((pair) => pair.targetLoop)} onChange={setOfTarget} />
      <div class="buttons">
        <Button
          label="Pair"
          icon="connected"
          tip={isPaired ? "These two are paired." : others.length === 0 ? "Joins the two loops." : "Joins the two loops in place of their earlier pairs."}
          disabled={isPaired}
          onClick={() => void pair()}
        />
      </div>
    </>
  );
}

/** Focuses this block where the panel has moved it, once the page shows that. */
function focusAgain(): void {
  setTimeout(() => {
    if (document.activeElement === document.body) document.querySelector<HTMLElement>(".pair-by-name .more-button")?.focus();
  });
}

interface LoopChoiceProps {
  page: Page;
  of: MeshObject;
  chosen: LoopRef;
  /** Loops that have a pair. */
  paired: readonly number[];
  onChange: (loop: number) => void;
}

/** Chooses a loop of an object. It lights up in the view, and is described to screen readers. */
function LoopChoice({ page, of, chosen, paired, onChange }: LoopChoiceProps) {
  const { graft } = page.editor;
  const loops = graft.loops.value.get(of.mesh) ?? [];
  const choose = (loop: number) => {
    onChange(loop);
    graft.hovered.value = { mesh: of.mesh, loop };
    const shown = loops[loop];
    const centre = page.graft.loopCentre({ mesh: of.mesh, loop });
    if (shown !== undefined && centre !== undefined)
      page.editor.announce(
        `${of.name}, loop ${loop + 1}: ${counted(shown.vertices.length, "vertex", "vertices")}, ${formatNumber(shown.length, 3)} around, centre at ${centre.map((x) => formatNumber(x, 3)).join(", ")}.`,
      );
  };
  return (
    <div onFocusIn={() => (graft.hovered.value = chosen)} onFocusOut={() => (graft.hovered.value = null)}>
      <Select
        label={`Loop of ${of.name}`}
        value={String(chosen.loop)}
        choices={Array.from({ length: of.loops }, (_, loop) => {
          const around = loops[loop] === undefined ? "" : `, ${formatNumber(loops[loop].length, 3)} around`;
          return { value: String(loop), label: `Loop ${loop + 1}${around}${paired.includes(loop) ? ", paired" : ""}` };
        })}
        onChange={(loop) => choose(Number(loop))}
      />
    </div>
  );
}
