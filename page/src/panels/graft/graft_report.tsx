import { morePairs, needsPair, pairsToGoWords } from "../../app/graft/graft_words";
import { forFingers } from "../../app/pointer_kind";
import type { Page } from "../../app/page";
import { inPanelWords, noteWords, sentence } from "../../app/wording";
import { counted } from "../../app/units";
import { RemedyButton } from "../remedy_button";
import { Button } from "../ui/button";
import { Icon } from "../ui/icon";

/** Returns whether a rotation is a guess: below 60 % probable, with others to choose from. */
function isUnsure({ editor: { graft } }: Page): boolean {
  const told = graft.report.value?.pairs ?? [];
  return graft.pairs.value.some(
    ({ start, matches }, i) =>
      start === undefined && matches.length === 0 && (told[i]?.starts.length ?? 0) > 1 && told[i]!.confidence < 0.6,
  );
}

/** Offers to pair further loops, where there are some. */
function MorePairs({ page: { editor: { graft } } }: { page: Page }) {
  const more = graft.pairs.value.length > 0 ? morePairs(graft) : 0;
  if (more === 0) return null;
  return (
    <span>
      Up to {counted(more, "more pair")} can be made.{" "}
      {graft.arrangement.value === "result" && (
        <Button label="Pair more loops" onClick={() => (graft.arrangement.value = "apart")} />
      )}
    </span>
  );
}

/** The outcome of the graft: the error, or the quality of the seam and the notes. */
export function GraftReportView({ page }: { page: Page }) {
  const { graft } = page.editor;
  const report = graft.report.value;
  if (report === null)
    return (
      <p class="graft-state busy" role="status">
        Grafting…
      </p>
    );
  if (needsPair(graft))
    return (
      <div class="graft-state" role="status">
        <strong>{pairsToGoWords(graft)}</strong>
        <span>{forFingers("Click a loop of the model and the loop of the part to join to it.")}</span>
        {graft.arrangement.value === "result" && report.error !== undefined && <RemedyButton page={page} fact={report.error} />}
      </div>
    );
  if (report.error !== undefined) {
    const { problem, location, remedy } = inPanelWords(report.error);
    return (
      <div class="graft-state failed" role="alert">
        <strong>
          <Icon name="warning" size={15} /> {sentence(problem)}
        </strong>
        {location !== "" && <small>{location}</small>}
        {remedy !== "" && <span>{remedy}</span>}
        <RemedyButton page={page} fact={report.error} />
      </div>
    );
  }
  const { seam, inverted = 0, self_intersections: cuts = 0, seconds } = report;
  const unsure = isUnsure(page);
  const notes = (report.notes ?? []).filter(({ id }) => !unsure || id !== "merge.start_unsure"); // told already
  const whole = seam?.manifold === true && seam.oriented;
  return (
    <div class="graft-state" role="status">
      {seam !== undefined && (
        <strong class={whole ? "good" : "bad"}>
          {whole
            ? seam.closed
              ? "Watertight seam"
              : "Seam without gaps, open elsewhere"
            : "The seam is not manifold"}
        </strong>
      )}
      {seam !== undefined && (
        <small>
          {seam.new_faces} new faces, smallest angle {seam.angle_p1_deg.toFixed(0)}°, sharpest bend{" "}
          {seam.dihedral_p99_deg.toFixed(0)}°{seconds === undefined ? "" : `, ${seconds.toFixed(2)} s`}
        </small>
      )}
      <MorePairs page={page} />
      {unsure && (
        <span class="unsure">Rotation unclear. If it is wrong, choose another one below, or use Twist.</span>
      )}
      {inverted > 0 && <span class="bad">The part turns inside out at {counted(inverted, "vertex", "vertices")}.</span>}
      {cuts > 0 && <span class="bad">{counted(cuts, "self-intersecting pair")} of faces.</span>}
      {notes.length > 0 && (
        <details>
          <summary>{notes.length === 1 ? "1 note" : `${notes.length} notes`}</summary>
          <ul>
            {notes.map((note) => (
              <li key={noteWords(note)}>
                {noteWords(note)} <RemedyButton page={page} fact={note} />
              </li>
            ))}
          </ul>
        </details>
      )}
    </div>
  );
}
