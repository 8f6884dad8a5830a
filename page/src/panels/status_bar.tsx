import { useEffect, useState } from "preact/hooks";
import type { Box, RunningRequest } from "../app/editor";
import { graftWords, shownSize } from "../app/graft/graft_words";
import { liveWords, progressWords } from "../app/live_words";
import type { Page } from "../app/page";
import { changeLabel } from "../app/request_labels";
import { counted, formatCount, formatPercent, formatSeconds, formatSize, formatSizeInMm, type Unit } from "../app/units";
import { Icon } from "./ui/icon";

/** The bar at the bottom: the engine's activity, the quality of what is shown, and the size of the model. */
export function StatusBar({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const grafts = state !== null && editor.graft.mode.value === "graft";
  const words = grafts ? graftWords(editor.graft) : liveWords(state, editor.live.value);
  return (
    <footer class="status" aria-label="Status">
      <Progress page={page} />
      <span class={`stage ${words.tone}`} role="status" data-tip={words.explained}>
        {words.tone === "warning" || words.tone === "problem" ? (
          <Icon name="warning" size={14} />
        ) : (
          <i class="dot" />
        )}
        {words.text}
      </span>
      {!grafts && <LiveFigures page={page} />}
      <span class="space" />
      {grafts ? <ShownFigures page={page} /> : state !== null && <ModelFigures page={page} />}
    </footer>
  );
}

function LiveFigures({ page }: { page: Page }) {
  const { editor } = page;
  const { seconds, error_rel } = editor.live.value;
  const setup = editor.setupSeconds.value;
  if (editor.state.value?.counts == null) return null;
  return (
    <>
      {seconds !== undefined && (
        <span data-tip="Time to compute the last frame.">frame {formatSeconds(seconds)}</span>
      )}
      {setup !== undefined && (
        <span data-tip="Time until the exact solution was ready.">set-up {formatSeconds(setup)}</span>
      )}
      {error_rel !== undefined && error_rel > 0 && (
        <span data-tip="Deviation of the preview from the exact shape, relative to the movement.">
          ± {formatPercent(error_rel)}
        </span>
      )}
    </>
  );
}

function ModelFigures({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const box = page.shownBox.value ?? editor.box.value;
  const selected = editor.selected.value;
  if (state === null) return null;
  const { model, counts } = state;
  return (
    <>
      {selected > 0 && <span class="selected-count">{formatCount(selected)} selected</span>}
      {counts !== null && (
        <span data-tip="Vertices of the region, and those of them that are neither handle nor fixed.">
          region {formatCount(counts.region)}, free {formatCount(counts.free)}
        </span>
      )}
      <span class="wide-only">{counted(model.vertices, "vertex", "vertices")}</span>
      <span class="wide-only">{counted(model.faces, "face")}</span>
      {box !== null && (
        <span data-tip={sizeTip("the model", sidesOf(box), editor.view.unit.value)}>
          {formatSize(sidesOf(box), editor.view.unit.value)}
        </span>
      )}
    </>
  );
}

/** In graft mode: the size of everything shown, result and parts. */
function ShownFigures({ page }: { page: Page }) {
  const { editor, viewport } = page;
  const [size] = useState(() =>
    shownSize(editor.graft, (mesh) => {
      const { value: box } = page.shownBox; // of the model, deformed
      const isModel = mesh === editor.state.value?.model.mesh;
      return isModel && box !== null ? sidesOf(box) : viewport.surfaceOf(mesh)?.size.toArray();
    }),
  );
  const { vertices, faces, sides } = size.value;
  const selected = editor.graft.paintsFixed.value ? editor.selected.value : 0;
  return (
    <>
      {selected > 0 && <span class="selected-count">{formatCount(selected)} selected</span>}
      <span class="wide-only" data-tip="Everything shown, including parts.">
        {counted(vertices, "vertex", "vertices")}
      </span>
      <span class="wide-only">{counted(faces, "face")}</span>
      {sides !== undefined && (
        <span data-tip={sizeTip("what is shown", sides, editor.view.unit.value)}>
          {formatSize(sides, editor.view.unit.value)}
        </span>
      )}
    </>
  );
}

function sizeTip(around: string, sides: readonly number[], unit: Unit): string {
  const inMm = formatSizeInMm(sides, unit);
  return `Bounding box of ${around}${inMm === "" ? "" : `: ${inMm}`}. Set the unit under View.`;
}

export function sidesOf({ low, high }: Box): number[] {
  return high.map((most, k) => most - (low[k] ?? 0));
}

const patienceMs = 300; // shorter work is not shown

/**
 * The progress of the longest-running request, with a bar and a button to cancel. Without one, the progress of the
 * set-up in the background.
 */
function Progress({ page }: { page: Page }) {
  const { editor } = page;
  const oldest = [...editor.working.value.values()].reduce<RunningRequest | undefined>(
    (a, b) => (a === undefined || b.since < a.since ? b : a),
    undefined,
  );
  const late = useLate(oldest);
  const setup = editor.progress.value.get("null");
  if (oldest !== undefined && late) {
    const event = editor.progress.value.get(String(oldest.id));
    return (
      <>
        <Bar fraction={event?.fraction ?? -1} label={oldest.label} />
        <span class="working" role="status">
          {oldest.label}
          {event !== undefined ? `: ${progressWords(event)}` : "…"}
        </span>
        <button type="button" class="cancel" onClick={() => editor.cancel(oldest.id)}>
          Cancel
        </button>
      </>
    );
  }
  if (setup === undefined) return null;
  return (
    <>
      <Bar fraction={setup.fraction} label="Preparing the exact shape" />
      <span class="working">{progressWords(setup)}</span>
      <SetUpCancel page={page} />
    </>
  );
}

/** A button that undoes the change that started the set-up. It is absent if the model was just opened. */
function SetUpCancel({ page }: { page: Page }) {
  const { editor } = page;
  const label = editor.state.value?.set_up_for ?? null;
  if (label === null) return null;
  return (
    <button
      type="button"
      class="cancel"
      data-tip={`Stops, and undoes: ${changeLabel(label)}.`}
      onClick={() => void editor.cancelSetUp()}
    >
      Cancel
    </button>
  );
}

function Bar({ fraction, label }: { fraction: number; label: string }) {
  const known = fraction >= 0;
  const percent = Math.round(100 * Math.min(1, fraction));
  return (
    <span
      class={`bar ${known ? "" : "unknown"}`}
      role="progressbar"
      aria-label={label}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={known ? percent : undefined}
    >
      <i style={{ width: known ? `${percent}%` : undefined }} />
    </span>
  );
}

/** Returns whether work has gone on for longer than `patienceMs`. */
function useLate(work: RunningRequest | undefined): boolean {
  const [late, setLate] = useState<unknown>(undefined);
  useEffect(() => {
    if (work === undefined) return undefined;
    const timer = setTimeout(
      () => setLate(work.id),
      Math.max(0, patienceMs - (performance.now() - work.since)),
    );
    return () => clearTimeout(timer);
  }, [work?.id]);
  return work !== undefined && late === work.id;
}
