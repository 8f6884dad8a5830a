import { useEffect, useState } from "preact/hooks";

interface Tip {
  label: string;
  text: string;
  keys: string;
  x: number;
  y: number;
  side: "below" | "right" | "left";
}

const delayMs = 450;
const tooltipId = "tooltip";

/** Shows `data-label`, `data-tip` and `data-keys` of the element under the pointer or with keyboard focus. */
export function Tooltips() {
  const [tip, setTip] = useState<Tip | null>(null);
  useEffect(() => {
    let timer = 0;
    let described: HTMLElement | undefined; // the element that names the tooltip as its description
    const hide = () => {
      clearTimeout(timer);
      described?.removeAttribute("aria-describedby");
      described = undefined;
      setTip(null);
    };
    const describe = (target: HTMLElement) => {
      if (target.hasAttribute("aria-describedby")) return;
      target.setAttribute("aria-describedby", tooltipId);
      described = target;
    };
    const plan = (target: EventTarget | null, delay: number) => {
      hide();
      if (!(target instanceof Element)) return;
      const element = target.closest<HTMLElement>("[data-tip]");
      if (element === null) return;
      timer = window.setTimeout(() => setTip(tipOf(element)), delay);
    };
    const over = (event: PointerEvent) => event.pointerType !== "touch" && plan(event.target, delayMs);
    const focus = (event: FocusEvent) =>
      event.target instanceof HTMLElement &&
      event.target.matches(":focus-visible") &&
      (plan(event.target, delayMs), event.target.closest("[data-tip]") !== null && describe(event.target));
    const events = ["pointerdown", "keydown", "wheel", "blur"] as const;
    document.addEventListener("pointerover", over);
    document.addEventListener("focusin", focus);
    for (const name of events) window.addEventListener(name, hide, { capture: true, passive: true });
    return () => {
      hide();
      document.removeEventListener("pointerover", over);
      document.removeEventListener("focusin", focus);
      for (const name of events) window.removeEventListener(name, hide, { capture: true });
    };
  }, []);
  if (tip === null) return null;
  return (
    <div class={`tooltip ${tip.side}`} role="tooltip" id={tooltipId} style={{ left: `${tip.x}px`, top: `${tip.y}px` }}>
      {tip.label !== "" && (
        <strong>
          {tip.label} {tip.keys !== "" && <kbd>{tip.keys}</kbd>}
        </strong>
      )}
      {tip.text !== "" && <span>{tip.text}</span>}
    </div>
  );
}

function tipOf(element: HTMLElement): Tip | null {
  const { tip: text = "", label = "", keys = "" } = element.dataset;
  if ((text === "" && label === "") || !element.isConnected) return null;
  const box = element.getBoundingClientRect();
  const panel = element.closest(".side") !== null;
  const bar = element.closest(".toolbar") !== null;
  if (panel) return { label, text, keys, side: "left", x: box.left - 8, y: box.top + box.height / 2 };
  if (bar) return { label, text, keys, side: "right", x: box.right + 8, y: box.top + box.height / 2 };
  const x = Math.min(window.innerWidth - 150, Math.max(150, box.left + box.width / 2));
  const up = box.bottom + 80 > window.innerHeight;
  return { label, text, keys, side: "below", x, y: up ? box.top - 56 : box.bottom + 8 };
}
