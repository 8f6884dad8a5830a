import { chordLabel } from "../app/chord";
import { commandOf, type Page } from "../app/page";
import { Button, HoldButton, IconButton } from "./ui/button";
import type { IconName } from "./ui/icon";
import type { MenuItem } from "./ui/menu";

interface CommandProps {
  page: Page;
  id: string;
  icon: IconName;
  /** Replaces the command's own label. */
  label?: string;
  tip?: string;
  class?: string;
  tabIndex?: number;
}

export function keysOf(keys: readonly string[]): string | undefined {
  const first = keys[0];
  return first === undefined ? undefined : chordLabel(first);
}

/** A button with an icon for a command of the table. */
export function CommandButton({ page, id, icon, label, tip, class: name, tabIndex }: CommandProps) {
  const command = commandOf(page, id);
  const common = {
    label: label ?? command.label,
    icon,
    tip: tip ?? command.help,
    keys: keysOf(command.keys),
    pressed: command.active?.(),
    disabled: !command.enabled(),
    class: name,
    tabIndex,
  };
  const { release } = command;
  if (release !== undefined)
    return <HoldButton {...common} onHold={(held) => (held ? command.run() : command.release?.())} />;
  return <IconButton {...common} onClick={() => command.run()} />;
}

/** A button with the label of a command of the table. */
export function CommandLabelButton({
  page,
  id,
  icon,
  kind,
  label,
}: CommandProps & { kind?: "plain" | "primary" | "quiet" }) {
  const command = commandOf(page, id);
  return (
    <Button
      label={label ?? command.label}
      icon={icon}
      tip={command.help}
      keys={keysOf(command.keys)}
      kind={kind}
      disabled={!command.enabled()}
      onClick={() => command.run()}
    />
  );
}

export function menuItem(page: Page, id: string, icon?: IconName): MenuItem {
  const command = commandOf(page, id);
  return {
    label: command.label,
    run: () => command.run(),
    icon,
    keys: keysOf(command.keys),
    disabled: !command.enabled(),
  };
}
