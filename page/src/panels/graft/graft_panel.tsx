import { useEffect, useRef } from "preact/hooks";
import type { Arrangement } from "../../app/graft/graft";
import { cssColour, pairColour } from "../../app/graft/graft_colours";
import { asTyped, counted } from "../../app/units";
import type { GraftFields, GraftStep } from "../../app/graft/graft_step";
import { withoutMatch, withoutPair } from "../../app/graft/graft_step";
import { setAsideWords } from "../../app/graft/set_aside";
import { pairingWords } from "../../app/graft/graft_words";
import { forFingers, pointerKind } from "../../app/pointer_kind";
import type { Page } from "../../app/page";
import { PartLibrary } from "./graft_library";
import { CutInWork, CutPanel } from "./graft_cut";
import { PartsPanel } from "./graft_parts";
import { BlendColours, GraftNumbers, LoopToggles, MirrorField, ShapeField } from "./graft_fields";
import { GraftReportView } from "./graft_report";
import { PairByName } from "./pair_by_name";
import { Rotations } from "./rotations";
import { Button, IconButton } from "../ui/button";
import { degrees, Segments, Slider } from "../ui/fields";
import { More, Section } from "../ui/section";
import "./graft.css";

/** All panels of graft mode. */
export function GraftPanels({ page }: { page: Page }) {
  const { graft } = page.editor;
  const inWork = graft.isEdited.value;
  const top = useRef<HTMLDivElement>(null);
  // The next action is at the top, so scroll there even if the user has scrolled down through the library.
  useEffect(() => top.current?.scrollIntoView({ block: "nearest" }), [inWork, graft.parts.value.length, graft.tool.value]);
  return (
    <>
      <div ref={top} class="graft-top" />
      {inWork && <GraftPanel page={page} />}
      {!inWork && <CutInWork page={page} />}
      {!inWork && <Pairing page={page} />}
      <PartsPanel page={page} />
      <PartLibrary page={page} />
      <CutPanel page={page} />
    </>
  );
}

/** Tells the user what to do next, before a graft is in progress. */
function Pairing({ page }: { page: Page }) {
  const { graft } = page.editor;
  const words = pairingWords(graft);
  if (words === undefined || graft.tool.value !== "loops") return null;
  return (
    <>
      <p class="next-step">{words}</p>
      <PairByName page={page} />
    </>
  );
}

const arrangements = [
  { value: "result", label: "Result", help: "The grafted mesh with its seam." },
  {
    value: "both",
    label: "With part",
    help: "The result with the part beside it, and lines between matching points.",
  },
  { value: "apart", label: "Apart", help: "Model and part as they were, with lines between matching points." },
] as const;

function GraftPanel({ page }: { page: Page }) {
  const { graft } = page.editor;
  const step = graft.step.value;
  if (step === undefined) return null;
  const keep = (fields: GraftFields) => void graft.set(fields);
  const setAside = page.editor.state.value?.graft?.set_aside.length ?? 0;
  return (
    <Section
      title="Graft"
      hint={`${step.source} onto ${step.target}.`}
      startsOpen
    >
      <Segments
        label="Shown"
        hideLabel
        value={graft.arrangement.value}
        choices={arrangements}
        onChange={(value: Arrangement) => (graft.arrangement.value = value)}
      />
      {step.at === undefined && <Pairs page={page} />}
      <BaseHint page={page} />
      <Sliders page={page} step={step} />
      <ShapeField step={step} keep={keep} />
      <MirrorField
        step={step}
        keep={keep}
        middle={() => page.graft.centreOf(graft.source.value?.mesh ?? -1)}
      />
      {step.at === undefined && <PoseFields page={page} step={step} />}
      <More label="More options">
        <BlendColours page={page} step={step} keep={keep} />
        <LoopToggles step={step} keep={keep} />
        <Button
          label="Swap part and model"
          icon="reset"
          tip="Grafts the model onto the part instead."
          disabled={setAside > 0}
          onClick={() => void page.editor.ask({ do: "graft", what: "swap" })}
        />
      </More>
      <GraftReportView page={page} />
      {setAside > 0 && <p class="hint">{setAsideWords(setAside)}</p>}
      <div class="graft-end">
        <Button
          label="Accept"
          icon="accept"
          kind="primary"
          keys="Ctrl+Enter"
          tip="Finishes the graft. The next step starts from it."
          disabled={graft.report.value?.error !== undefined}
          onClick={() => void graft.accept()}
        />
        <Button
          label="Cancel"
          kind="quiet"
          tip="Discards the graft. The part stays, unless it was dropped onto the surface. A graft that you edit again goes back to what it was."
          onClick={() => void graft.cancel()}
        />
      </div>
    </Section>
  );
}

/** Tells of the grips of the plane that opens a closed part. */
function BaseHint({ page }: { page: Page }) {
  const { graft } = page.editor;
  if (graft.step.value?.at === undefined || graft.report.value?.base === undefined) return null;
  const hand = pointerKind.value === "touch" ? "With a finger, drag" : "Drag";
  return <p class="hint">{hand} the blue grips in the view: the one with the straight arrow for the height of the base, the one with the bent arrow for its tilt.</p>;
}

function Pairs({ page }: { page: Page }) {
  const { graft } = page.editor;
  const pairs = graft.pairs.value;
  const report = graft.report.value;
  return (
    <>
      {pairs.length === 0 && <p class="hint">{forFingers("Click a loop on each mesh to pair them.")}</p>}
      <ul class="list pairs-list" aria-label="Pairs of loops">
        {pairs.map((pair, i) => {
          const found = pair.start === undefined && pair.matches.length === 0;
          const confidence = report?.pairs?.[i]?.confidence;
          return (
            <li key={i} class={i === graft.activePair.value ? "active" : ""}>
              <button
                type="button"
                class="list-main"
                onClick={() => (graft.activePair.value = i)}
              >
                <span class="pair-number" style={{ background: cssColour(pairColour(i)) }}>
                  <span class="hidden">Pair </span>
                  {i + 1}
                </span>
                <span class="list-name">
                  {loopWords(pair.sourceLoop)} → {loopWords(pair.targetLoop)}
                  <small>
                    {found
                      ? confidenceWords(confidence)
                      : `${graft.starts.isCandidate(i) ? "chosen below" : "set by hand"}${pair.matches.length > 0 ? `, ${counted(pair.matches.length, "more match", "more matches")}` : ""}`}
                  </small>
                </span>
                {found && confidence !== undefined && (
                  <meter
                    min={0}
                    max={1}
                    low={0.6}
                    high={0.8}
                    optimum={1}
                    value={confidence}
                    aria-label={`Rotation of pair ${i + 1}`}
                  />
                )}
              </button>
              {!found && (
                <IconButton
                  label={`Reset pair ${i + 1}`}
                  icon="reset"
                  onClick={() =>
                    void graft.setPairs(
                      pairs.map((other, k) =>
                        k === i ? { ...withoutMatch([other], { pair: 0, match: 0 })[0]!, matches: [] } : other,
                      ),
                    )
                  }
                />
              )}
              {pairs.length > 1 && (
                <IconButton
                  label={`Remove pair ${i + 1}`}
                  icon="close"
                  onClick={() => void graft.setPairs(withoutPair(pairs, i))}
                />
              )}
              <Rotations page={page} index={i} pair={pair} />
            </li>
          );
        })}
      </ul>
      <PairByName page={page} />
    </>
  );
}

function loopWords(loop: number): string {
  return loop < 0 ? "a loop" : `loop ${loop + 1}`;
}

function confidenceWords(confidence: number | undefined): string {
  if (confidence === undefined) return "rotation found";
  return confidence < 0.6 ? "rotation unclear" : confidence < 0.8 ? "rotation likely" : "rotation clear";
}

// The sliders show the document's values. A slider that is being dragged keeps its own value.
function Sliders({ page, step: shown }: { page: Page; step: GraftStep }) {
  const { graft } = page.editor;
  return (
    <GraftNumbers
      step={graft.kept.value ?? shown}
      foundSize={graft.report.value?.size}
      foundBase={graft.report.value?.base?.height}
      drag={(fields) => graft.drag(fields)}
      keep={(fields) => void graft.set(fields)}
      twist={<Twist page={page} />}
    />
  );
}

/** Turns the start of the chosen pair along its loop. */
function Twist({ page }: { page: Page }) {
  const { graft } = page.editor;
  const index = graft.activePair.value;
  const pair = graft.pairs.value[index];
  const held = pair === undefined || pair.matches.length > 0 || graft.starts.curvesOf(pair) === undefined;
  const asked = useRef(0); // -180° and 180° are the same rotation; shown as typed
  const twist = (value: number, then: "drag" | "keep") => {
    const pairs = graft.starts.withTwist(index, value);
    if (pairs === undefined) return;
    asked.current = value;
    if (then === "drag") graft.dragPairs(pairs);
    else void graft.setPairs(pairs);
  };
  const found = held ? 0 : graft.starts.twistOf(index, graft.keptPairs.value);
  const turned = asTyped(Math.round(10 * found) / 10, asked.current);
  return (
    <Slider
      label="Twist"
      {...degrees}
      step={5}
      digits={3}
      value={held ? 0 : turned}
      disabled={held}
      help={
        (pair?.matches.length ?? 0) > 0
          ? "Set by the matches."
          : `Rotates the part${graft.pairs.value.length > 1 ? ` at pair ${index + 1}` : ""} along its loop, relative to the rotation found.`
      }
      onInput={(value) => twist(value, "drag")}
      onChange={(value) => twist(value, "keep")}
    />
  );
}

function PoseFields({ page, step }: { page: Page; step: GraftStep }) {
  const { graft } = page.editor;
  const choose = (pose: "find" | "keep") => {
    if (pose === step.pose) return;
    if (pose === "find") {
      graft.tool.value = "loops";
      void graft.set({ pose: null, source_transform: null, fixed: null });
    } else void graft.set({ pose: "keep", source_transform: page.graft.foundPose(), size: null });
  };
  const painting = graft.tool.value === "fixed";
  return (
    <>
      <Segments
        label="Placement"
        value={step.pose}
        help="Automatic: the loops determine where the part goes. Manual: you place it with the gizmo, and it bends near its loops only."
        choices={[
          { value: "find", label: "Automatic" },
          { value: "keep", label: "Manual" },
        ]}
        onChange={choose}
      />
      {step.pose === "keep" && (
        <div class="buttons">
          <Button
            label={painting ? "Done painting" : "Paint fixed area"}
            icon={painting ? "accept" : "fixed"}
            tip="Paint areas of the part that must not bend."
            onClick={() => (painting ? graft.donePainting() : void graft.paintFixed())}
          />
          {step.hasFixed && (
            <Button label="Clear fixed area" kind="quiet" onClick={() => void graft.set({ fixed: null })} />
          )}
        </div>
      )}
    </>
  );
}
