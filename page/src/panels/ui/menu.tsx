import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { Icon, type IconName } from "./icon";

export interface MenuItem {
  label: string;
  run: () => void;
  icon?: IconName;
  keys?: string | undefined;
  disabled?: boolean;
  danger?: boolean;
  /** Whether a line above separates the item. */
  begins?: boolean;
}

interface MenuProps {
  label: string;
  items: readonly MenuItem[];
  icon?: IconName;
  children?: ComponentChildren;
  class?: string;
}

/** A button that opens a list of commands. Arrows, home, end and escape work as usual in menus. */
export function Menu({ label, items, icon, children, class: name }: MenuProps) {
  const [position, setPosition] = useState<{ x: number; y: number; up: boolean } | null>(null);
  const button = useRef<HTMLButtonElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const close = () => {
    setPosition(null);
    button.current?.focus();
  };
  const open = () => {
    const box = button.current?.getBoundingClientRect();
    if (box === undefined) return;
    const up = box.bottom + 34 * items.length + 16 > window.innerHeight;
    setPosition({
      x: Math.max(4, Math.min(box.left, window.innerWidth - 232)),
      y: up ? box.top : box.bottom,
      up,
    });
  };
  // Moves the focus before the list is painted, so that a key pressed right after opening goes to the list.
  useLayoutEffect(() => {
    if (position === null) return undefined;
    list.current?.querySelector<HTMLElement>("[role=menuitem]:not([disabled])")?.focus();
    const outside = (event: PointerEvent) => {
      if (!(event.target instanceof Node)) return;
      if (!list.current?.contains(event.target) && !button.current?.contains(event.target)) setPosition(null);
    };
    window.addEventListener("pointerdown", outside, true);
    return () => window.removeEventListener("pointerdown", outside, true);
  }, [position]);
  return (
    <>
      <button
        type="button"
        ref={button}
        class={name ?? "icon-button"}
        aria-haspopup="menu"
        aria-expanded={position !== null}
        aria-label={children === undefined ? label : undefined}
        data-label={label}
        data-tip={position === null ? "" : undefined}
        onClick={(event) => {
          event.stopPropagation();
          if (position === null) open();
          else close();
        }}
      >
        {children ?? <Icon name={icon ?? "more"} />}
      </button>
      {position !== null && (
        <div
          ref={list}
          class={`menu ${position.up ? "up" : ""}`}
          role="menu"
          aria-label={label}
          style={{ left: `${position.x}px`, top: `${position.y}px` }}
          onKeyDown={(event) => goInMenu(event, list.current, close)}
          onClick={(event) => event.stopPropagation()}
        >
          {items.map((item) => (
            <button
              type="button"
              role="menuitem"
              key={item.label}
              tabIndex={-1}
              disabled={item.disabled}
              class={`${item.begins === true ? "begins" : ""} ${item.danger === true ? "danger" : ""}`}
              onClick={() => {
                close();
                item.run();
              }}
            >
              {item.icon === undefined ? <span class="icon" /> : <Icon name={item.icon} size={16} />}
              <span>{item.label}</span>
              {item.keys !== undefined && <kbd>{item.keys}</kbd>}
            </button>
          ))}
        </div>
      )}
    </>
  );
}

function goInMenu(event: KeyboardEvent, list: HTMLElement | null, close: () => void): void {
  event.stopPropagation();
  if (event.key === "Escape" || event.key === "Tab") {
    event.preventDefault();
    return close();
  }
  const items = [...(list?.querySelectorAll<HTMLElement>("[role=menuitem]:not([disabled])") ?? [])];
  const at = items.findIndex((item) => item === document.activeElement);
  const next: Partial<Record<string, number>> = {
    ArrowDown: (at + 1) % items.length,
    ArrowUp: (at - 1 + items.length) % items.length,
    Home: 0,
    End: items.length - 1,
  };
  const index = next[event.key];
  if (index === undefined) return;
  event.preventDefault();
  items[index]?.focus();
}
