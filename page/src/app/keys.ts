import { chordOf, matches, parseChord, type KeyPress } from "./chord";

/** Where a command stands in menus and on the help sheet. */
export type CommandGroup = "file" | "edit" | "tool" | "select" | "handle" | "view" | "help";

/** Something that the person can do: by its keys, from a menu or by a button. All of them stand in one table. */
export interface Command {
  readonly id: string;
  readonly label: string;
  /** One line for tooltips and the help sheet. */
  readonly help: string;
  readonly group: CommandGroup;
  /** As `parseChord` reads them: "ctrl+shift+Z", "?", "Num1". The first one is shown. Empty: no keys. */
  readonly keys: readonly string[];
  run(): void;
  /** Of a command that is held: its key goes up. */
  release?(): void;
  /** Reads signals, so that buttons follow. */
  enabled(): boolean;
  /** Of a tool or a switch: whether it is on. Reads signals. */
  active?(): boolean;
  /** Goes on while the key is down (undo, brush size). */
  readonly repeats?: boolean;
}

/** A command that a press asks for, if it can be done now. */
export function commandFor(commands: readonly Command[], press: KeyPress): Command | undefined {
  return commands.find((command) => command.keys.some((keys) => matches(parseChord(keys), press)));
}

/** Whether typing belongs to `target`: keys are no commands there, but for those of `isForAll`. */
export function takesTyping(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.isContentEditable || target instanceof HTMLTextAreaElement) return true;
  if (target instanceof HTMLSelectElement) return true;
  const noText = ["button", "checkbox", "color", "radio", "range", "file", "submit", "reset"];
  return target instanceof HTMLInputElement && !noText.includes(target.type);
}

/**
 * Files are saved and opened from a field, too. Where nothing has been typed since it was confirmed (`data-confirmed`),
 * and in lists, all commands with ctrl go on, but those of the text itself.
 */
function isForAll(command: Command, press: KeyPress, target: EventTarget | null): boolean {
  const { ctrl, key } = chordOf(press);
  if (!ctrl) return false;
  const isText = target instanceof HTMLElement && !(target instanceof HTMLSelectElement) && target.dataset["confirmed"] === undefined;
  return command.group === "file" || !(isText || ["A", "C", "V", "X"].includes(key));
}

/**
 * Gives keys to commands. `first` sees each press before (a gesture that takes numbers and axes) and returns
 * whether it took it. Returns what takes the listeners away.
 */
export function listenForKeys(
  commands: () => readonly Command[],
  first: (event: KeyboardEvent) => boolean = () => false,
): () => void {
  const held = new Map<string, Command>(); // by the code of the key
  const down = (event: KeyboardEvent) => {
    if (event.defaultPrevented || event.isComposing) return;
    const { target } = event;
    const types = takesTyping(target);
    if (!types && first(event)) return event.preventDefault();
    const command = commandFor(commands(), event);
    if (command === undefined || ownsKey(event) || (types && !isForAll(command, event, target))) return;
    event.preventDefault(); // even where it cannot be done now: ctrl+S must not save the page
    if (types && target instanceof HTMLInputElement) target.blur(); // what is typed counts
    if (!command.enabled() || (event.repeat && command.repeats !== true)) return;
    if (command.release !== undefined) held.set(event.code, command);
    command.run();
  };
  const up = (event: KeyboardEvent) => {
    held.get(event.code)?.release?.();
    held.delete(event.code);
  };
  const leave = () => {
    for (const command of held.values()) command.release?.();
    held.clear();
  };
  window.addEventListener("keydown", down);
  window.addEventListener("keyup", up);
  window.addEventListener("blur", leave);
  return () => {
    window.removeEventListener("keydown", down);
    window.removeEventListener("keyup", up);
    window.removeEventListener("blur", leave);
  };
}

/** Enter and space work a focused button, arrows a slider: these stay with what has the focus. */
function ownsKey(event: KeyboardEvent): boolean {
  if (!(event.target instanceof HTMLElement) || event.target === document.body) return false;
  const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
  return plain && ["Enter", " ", "Tab", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"].includes(event.key);
}
