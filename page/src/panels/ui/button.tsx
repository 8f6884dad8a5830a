import type { ComponentChildren } from "preact";
import { Icon, type IconName } from "./icon";

interface ButtonProps {
  label: string;
  onClick: () => void;
  icon?: IconName;
  /** Tooltip. A button with only an icon shows its label. */
  tip?: string;
  keys?: string;
  kind?: "plain" | "primary" | "quiet" | "danger";
  disabled?: boolean;
  class?: string;
  autoFocus?: boolean;
  children?: ComponentChildren;
}

export function Button(props: ButtonProps) {
  const { label, icon, tip, keys, kind = "plain", disabled } = props;
  return (
    <button
      type="button"
      class={`button ${kind} ${props.class ?? ""}`}
      disabled={disabled}
      data-tip={tip}
      data-keys={keys}
      autoFocus={props.autoFocus}
      onClick={props.onClick}
    >
      {icon !== undefined && <Icon name={icon} />}
      <span>{props.children ?? label}</span>
    </button>
  );
}

interface IconButtonProps {
  label: string;
  icon: IconName;
  /** `isByKey`: the keyboard pressed it, and no pointer. */
  onClick: (isByKey: boolean) => void;
  tip?: string;
  keys?: string;
  pressed?: boolean;
  disabled?: boolean;
  class?: string;
  tabIndex?: number;
}

export function IconButton({
  label,
  icon,
  onClick,
  tip,
  keys,
  pressed,
  disabled,
  class: name,
  tabIndex,
}: IconButtonProps) {
  return (
    <button
      type="button"
      tabIndex={tabIndex}
      class={`icon-button ${name ?? ""}`}
      aria-label={label}
      aria-pressed={pressed}
      aria-disabled={disabled}
      data-label={label}
      data-tip={tip ?? ""}
      data-keys={keys}
      onClick={(event) => disabled !== true && onClick(event.detail === 0)}
    >
      <Icon name={icon} />
    </button>
  );
}

/** A button that acts while it is held, by the pointer or by space and enter. */
export function HoldButton(props: Omit<IconButtonProps, "onClick"> & { onHold: (held: boolean) => void }) {
  const { label, icon, tip, keys, pressed, disabled, onHold } = props;
  const isHolding = (event: KeyboardEvent) => event.key === " " || event.key === "Enter";
  return (
    <button
      type="button"
      class={`icon-button ${props.class ?? ""}`}
      aria-label={label}
      aria-pressed={pressed}
      aria-disabled={disabled}
      data-label={label}
      data-tip={tip ?? ""}
      data-keys={keys}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        if (disabled !== true) onHold(true);
      }}
      onPointerUp={(event) => {
        onHold(false);
        event.currentTarget.blur(); // Enter and Space are for the keyboard
      }}
      onPointerCancel={() => onHold(false)}
      onKeyDown={(event) => isHolding(event) && disabled !== true && onHold(true)}
      onKeyUp={(event) => isHolding(event) && onHold(false)}
      onBlur={() => onHold(false)}
    >
      <Icon name={icon} />
    </button>
  );
}
