import { useEffect, useState } from "preact/hooks";
import { likelihoodWords } from "../../app/graft/graft_words";
import type { Pair, StartCandidate } from "../../app/graft/graft_step";
import type { Page } from "../../app/page";

const wholeDegrees = (angle: number) => `${angle <= -179.5 ? 180 : Math.round(angle) || 0}°`;

/** The rotations that a user may have meant for a pair, each a small picture to click; nothing where there is one. */
export function Rotations({ page, index, pair }: { page: Page; index: number; pair: Pair }) {
  const { graft } = page.editor;
  const candidates = graft.starts.candidatesOf(index);
  if (candidates.length < 2) return null;
  const choose = (start: StartCandidate["start"] | undefined) =>
    void graft.setPairs(graft.pairs.value.map((other, i) => (i === index ? { ...other, start, matches: [] } : other)));
  // The slider Twist shows the same angle: none for the first, which is the rotation found. A turn counts the other way.
  const angleOf = (candidate: StartCandidate, i: number) =>
    wholeDegrees(i === 0 ? 0 : (graft.starts.twistOfCandidate(pair, candidate) ?? -candidate.turn_deg));
  const chosen = pair.start === undefined ? 0 : candidates.findIndex(({ start }) => String(start) === String(pair.start));
  return (
    <div class="rotations" role="group" aria-label={`Rotations of pair ${index + 1}`}>
      {candidates.map((candidate, i) => (
        <Rotation
          key={String(candidate.start)}
          page={page}
          pair={pair}
          candidate={candidate}
          angle={angleOf(candidate, i)}
          words={i === 0 ? "likeliest" : likelihoodWords(candidate.probability)}
          isChosen={pair.matches.length === 0 && chosen === i}
          onChoose={() => choose(i === 0 ? undefined : candidate.start)}
        />
      ))}
    </div>
  );
}

interface RotationProps {
  page: Page;
  pair: Pair;
  candidate: StartCandidate;
  angle: string;
  words: string;
  isChosen: boolean;
  onChoose: () => void;
}

function Rotation({ page, pair, candidate, angle, words, isChosen, onChoose }: RotationProps) {
  const [picture, setPicture] = useState<string | undefined>(undefined);
  const { start, probability } = candidate;
  const placed = String(page.editor.graft.report.value?.transform);
  useEffect(() => {
    let isWanted = true;
    void page.graft.startPicture(pair, candidate)?.then(
      (made) => isWanted && setPicture(made),
      () => undefined, // the button says the angle, too
    );
    return () => void (isWanted = false);
  }, [String(start), placed]);
  return (
    <button
      type="button"
      class="rotation"
      aria-pressed={isChosen}
      data-tip={`Rotated by ${angle}, ${Math.round(100 * probability)} % probable.`}
      onClick={onChoose}
    >
      {picture === undefined ? <span class="rotation-picture" /> : <img class="rotation-picture" src={picture} alt="" />}
      <span>{angle}</span>
      <small>{words}</small>
    </button>
  );
}
