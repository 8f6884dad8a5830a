import { useEffect, useId, useRef, useState } from "preact/hooks";
import type { Page } from "../app/page";
import { pointerKind } from "../app/pointer_kind";
import { tourSteps } from "../app/tour";
import { Button, IconButton } from "./ui/button";

interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

const bubbleWidth = 300;
const marginPx = 12;
const pollMs = 200; // what a bubble points at may move or appear

/** Returns the first of these elements that is shown. */
function shownAnchor(selectors: readonly string[]): Element | undefined {
  const elements = selectors.map((selector) => document.querySelector(selector));
  return elements.find((element) => element !== null && element.getBoundingClientRect().width > 0) ?? undefined;
}

function boxOf(element: Element): Box {
  const { left, top, width, height } = element.getBoundingClientRect();
  return { left, top, width, height };
}

/** Returns where a bubble stands beside what it points at, within the window: at a side if there is room, else below. */
export function besideAnchor(anchor: Box, bubble: { width: number; height: number }, window: { width: number; height: number }): { left: number; top: number } {
  const within = (value: number, most: number) => Math.max(marginPx, Math.min(value, most - marginPx));
  const right = anchor.left + anchor.width + marginPx;
  const top = within(anchor.top, window.height - bubble.height);
  const isLarge = anchor.width > 0.5 * window.width; // such as the view: in its corner
  if (isLarge) return { left: anchor.left + marginPx, top: within(anchor.top + anchor.height - bubble.height - 60, window.height - bubble.height) };
  if (right + bubble.width + marginPx <= window.width) return { left: right, top };
  if (anchor.left - bubble.width - marginPx >= marginPx) return { left: anchor.left - bubble.width - marginPx, top };
  const below = anchor.top + anchor.height + marginPx;
  return { left: within(anchor.left, window.width - bubble.width), top: within(below, window.height - bubble.height) };
}

/** The bubble of the tour, and a frame around what it points at. */
export function TourBubble({ page }: { page: Page }) {
  const { tour } = page;
  const { value: index } = tour.index;
  const { step } = tour;
  const bubble = useRef<HTMLDivElement>(null);
  const id = useId();
  const [anchor, setAnchor] = useState<Box | undefined>(undefined);
  useEffect(() => {
    if (step === undefined) return undefined;
    let broughtIntoView: Element | undefined; // once, because the user may scroll on
    const look = () => {
      const element = shownAnchor(step.anchors);
      if (element !== broughtIntoView) element?.scrollIntoView({ block: "nearest" });
      broughtIntoView = element;
      const now = element && boxOf(element);
      setAnchor((before) => (JSON.stringify(now) === JSON.stringify(before) ? before : now));
    };
    look();
    const timer = setInterval(look, pollMs);
    return () => clearInterval(timer);
  }, [step]);
  useEffect(() => {
    const { activeElement } = document;
    if (step !== undefined && (activeElement === document.body || bubble.current?.contains(activeElement) === true))
      bubble.current?.querySelector<HTMLElement>(".primary")?.focus();
  }, [step]);
  if (step === undefined || index === null || page.editor.dialog.value !== null || page.editor.pendingOpen.value !== null) return null;
  const size = { width: bubbleWidth, height: bubble.current?.offsetHeight ?? 180 };
  const at = besideAnchor(anchor ?? { left: 0, top: 60, width: 0, height: 0 }, size, { width: innerWidth, height: innerHeight });
  return (
    <>
      {anchor !== undefined && anchor.width < 0.5 * innerWidth && (
        <div class="tour-frame" style={{ left: `${anchor.left - 4}px`, top: `${anchor.top - 4}px`, width: `${anchor.width + 8}px`, height: `${anchor.height + 8}px` }} />
      )}
      <div
        ref={bubble}
        class="tour-bubble"
        role="dialog"
        aria-labelledby={`${id}-title`}
        aria-describedby={`${id}-words`}
        style={{ left: `${at.left}px`, top: `${at.top}px`, width: `${bubbleWidth}px` }}
      >
        <header>
          <h2 id={`${id}-title`}>{step.title}</h2>
          <IconButton label="Skip the tour" icon="close" keys="Esc" onClick={() => tour.skip()} />
        </header>
        <p id={`${id}-words`}>{pointerKind.value === "touch" ? (step.touchWords ?? step.words) : step.words}</p>
        <footer>
          <span class="hint">{`${index + 1} of ${tourSteps.length}`}</span>
          <span class="space" />
          {tour.canPass && <Button label="Next" tip="Goes on without this step." kind="quiet" onClick={() => tour.pass()} />}
          <Button label={step.action} kind="primary" disabled={!tour.canRun} onClick={() => void tour.run()} />
        </footer>
      </div>
    </>
  );
}
