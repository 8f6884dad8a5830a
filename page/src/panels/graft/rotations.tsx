import type { Pair, StartCandidate } from "../../app/graft/graft_step";
import type { Page } from "../../app/page";

/** Returns the angle that the slider Twist shows for a turn; it counts the other way. */
const twistOf = (turnDeg: number) => (turnDeg <= -180 ? 180 : Math.round(-turnDeg) || 0);

/** The rotations that a user may have meant for a pair, each a button; nothing where there is one. */
export function Rotations({ page, index, pair }: { page: Page; index: number; pair: Pair }) {
  const { graft } = page.editor;
  const candidates = graft.starts.candidatesOf(index);
  if (candidates.length < 2) return null;
  const choose = (start: StartCandidate["start"] | undefined) =>
    void graft.setPairs(graft.pairs.value.map((other, i) => (i === index ? { ...other, start, matches: [] } : other)));
  const chosen = pair.start === undefined ? 0 : candidates.findIndex(({ start }) => String(start) === String(pair.start));
  return (
    <div class="rotations" role="group" aria-label={`Rotations of pair ${index + 1}`}>
      {candidates.map(({ start, probability, turn_deg }, i) => (
        <button
          key={String(start)}
          type="button"
          class="button quiet"
          aria-pressed={pair.matches.length === 0 && chosen === i}
          data-tip={i === 0 ? "The likeliest rotation" : "Rotates the part to this angle from the likeliest rotation"}
          onClick={() => choose(i === 0 ? undefined : start)}
        >
          {`${twistOf(turn_deg)}°`} <small>{`${Math.round(100 * probability)} %`}</small>
        </button>
      ))}
    </div>
  );
}
