import type { ComponentChildren } from "preact";
import { useId, useLayoutEffect, useRef } from "preact/hooks";
import { remembered } from "../../app/remembered";
import { Icon } from "./icon";

interface SectionProps {
  title: string;
  /** One line that says what the section is for. */
  hint: string;
  /** Shown beside the title: a count or a state. */
  badge?: ComponentChildren;
  startsOpen?: boolean;
  children: ComponentChildren;
}

/** A collapsible section of the side panel. The browser remembers whether it is open. */
export function Section({ title, hint, badge, startsOpen = false, children }: SectionProps) {
  const open = remembered(`section ${title}`, startsOpen);
  const id = useId();
  const section = useRef<HTMLElement>(null);
  const unfolded = useRef(false);
  useLayoutEffect(() => {
    if (unfolded.current) section.current?.scrollIntoView({ block: "nearest" });
    unfolded.current = false;
  }, [open.value]);
  return (
    <section ref={section} class={`section ${open.value ? "open" : ""}`} aria-label={title}>
      <h2>
        <button
          type="button"
          aria-expanded={open.value}
          aria-controls={id}
          onClick={() => {
            open.value = !open.value;
            unfolded.current = open.value;
          }}
        >
          <Icon name={open.value ? "down" : "right"} size={14} />
          <span>{title}</span>
          {badge !== undefined && <span class="badge">{badge}</span>}
        </button>
      </h2>
      {open.value && (
        <div class="section-body" id={id}>
          <p class="hint">{hint}</p>
          {children}
        </div>
      )}
    </section>
  );
}

/** A collapsible block for rarely needed fields. */
export function More({ label, children }: { label: string; children: ComponentChildren }) {
  const open = remembered(`more ${label}`, false);
  return (
    <div class="more">
      <button
        type="button"
        class="more-button"
        aria-expanded={open.value}
        onClick={() => (open.value = !open.value)}
      >
        <Icon name={open.value ? "down" : "right"} size={12} />
        {label}
      </button>
      {open.value && children}
    </div>
  );
}
