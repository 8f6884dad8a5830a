import type { ComponentChildren } from "preact";
import { useRef } from "preact/hooks";
import type { Page } from "../app/page";
import { CommandButton } from "./command_button";
import { hasIcon } from "./ui/icon";

const groups: readonly (readonly string[])[] = [
  ["navigate"],
  ["handle", "vertex", "curve"],
  ["brush", "lasso", "box", "connected", "loop", "flood"],
  ["measure", "flat"],
];

/** The tools, at the left. Arrow keys move between them; the tab key skips all of them. */
export function Toolbar({ page }: { page: Page }) {
  const bar = useRef<HTMLDivElement>(null);
  const active = page.editor.toolInUse.value;
  const onKeyDown = (event: KeyboardEvent) => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    const buttons = [...(bar.current?.querySelectorAll<HTMLElement>("button") ?? [])];
    const at = buttons.findIndex((button) => button === document.activeElement);
    if (step === 0 || at < 0) return;
    event.preventDefault();
    buttons[(at + step + buttons.length) % buttons.length]?.focus();
  };
  return (
    <ToolRail>
      <div class="tool-groups" ref={bar} role="toolbar" aria-orientation="vertical" aria-label="Tools" onKeyDown={onKeyDown}>
      {groups.map((tools, group) => (
        <div class="tool-group" key={group}>
          {tools.map((tool) => (
            <CommandButton
              key={tool}
              page={page}
              id={`tool-${tool}`}
              icon={hasIcon(tool) ? tool : "navigate"}
              tabIndex={tool === active ? 0 : -1}
            />
          ))}
        </div>
      ))}
      </div>
    </ToolRail>
  );
}

/** The strip at the left that holds the tools. */
export function ToolRail({ children }: { children: ComponentChildren }) {
  return (
    <nav class="toolbar" aria-label="Tool strip">
      {children}
    </nav>
  );
}
