import { chordOf, matches, parseChord, type KeyPress } from "./chord";
import { ClickedElements } from "./clicked";

/** The group of a command in menus and on the help sheet. */
export type CommandGroup = "file" | "edit" | "tool" | "select" | "handle" | "view" | "help";

/** An action of the user, by keys, from a menu or by a button. All commands are in one table. */
export interface Command {
  readonly id: string;
  readonly label: string;
  /** One line for tooltips and the help sheet. */
  readonly help: string;
  readonly group: CommandGroup;
  /** Chords as `parseChord` reads them: "ctrl+shift+Z", "?", "Num1". The first one is shown. Empty: no keys. */
  readonly keys: readonly string[];
  run(): void;
  /** For a command that acts while its key is held: called when the key goes up. */
  release?(): void;
  /** Returns whether the command can run. Reads signals, so that buttons update. */
  enabled(): boolean;
  /** For a tool or a switch: returns whether it is on. Reads signals. */
  active?(): boolean;
  /** Whether the command repeats while its key is down (undo, brush size). */
  readonly repeats?: boolean;
}

/** Returns the command of a key press; undefined if there is none. */
export function commandFor(commands: readonly Command[], press: KeyPress): Command | undefined {
  return commands.find((command) => command.keys.some((keys) => matches(parseChord(keys), press)));
}

/** Returns whether `target` takes typed text. There keys are no commands, except those that `isForAll` accepts. */
export function takesTyping(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.isContentEditable || target instanceof HTMLTextAreaElement) return true;
  if (target instanceof HTMLSelectElement) return true;
  const noText = ["button", "checkbox", "color", "radio", "range", "file", "submit", "reset"];
  return target instanceof HTMLInputElement && !noText.includes(target.type);
}

/**
 * Returns whether a command also works in a text field. File commands always do. Other commands with ctrl, except those
 * for editing text, work in lists and in a field without changes since it was confirmed (`data-confirmed`).
 */
function isForAll(command: Command, press: KeyPress, target: EventTarget | null): boolean {
  const { ctrl, key } = chordOf(press);
  if (!ctrl) return false;
  const isText = target instanceof HTMLElement && !(target instanceof HTMLSelectElement) && target.dataset["confirmed"] === undefined;
  return command.group === "file" || !(isText || ["A", "C", "V", "X"].includes(key));
}

/**
 * Listens for keys and runs their commands. `first` sees each press before (for gestures that take numbers and axes)
 * and returns whether it used it. A button that was clicked is not pressed again by Enter or Space; one that the keyboard
 * moved the focus to is. Returns a function that removes the listeners.
 */
export function listenForKeys(
  commands: () => readonly Command[],
  first: (event: KeyboardEvent) => boolean = () => false,
): () => void {
  const held = new Map<string, Command>(); // by the code of the key
  const clicked = new ClickedElements();
  const stopNotingClicks = clicked.listen();
  const ignored = new Set<string>(); // codes of keys that would press a clicked button
  const down = (event: KeyboardEvent) => {
    if (event.defaultPrevented || event.isComposing) return;
    const { target } = event;
    const types = takesTyping(target);
    if (!types && first(event)) return event.preventDefault();
    const command = commandFor(commands(), event);
    if (target instanceof HTMLElement && clicked.has(target) && isPressedBy(target, event.key)) {
      event.preventDefault();
      ignored.add(event.code);
    } else if (ownsKey(event)) return;
    if (command === undefined || (types && !isForAll(command, event, target))) return;
    event.preventDefault(); // also for disabled commands, so that ctrl+S does not save the page
    if (types && target instanceof HTMLInputElement) target.blur(); // commits the typed text
    if (!command.enabled() || (event.repeat && command.repeats !== true)) return;
    if (command.release !== undefined) held.set(event.code, command);
    command.run();
  };
  const up = (event: KeyboardEvent) => {
    if (ignored.delete(event.code)) event.preventDefault(); // some browsers click when Space goes up
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
    stopNotingClicks();
    window.removeEventListener("keydown", down);
    window.removeEventListener("keyup", up);
    window.removeEventListener("blur", leave);
  };
}

/** Returns whether this key clicks this element when it has the focus. */
export function isPressedBy({ localName, type }: { localName: string; type?: string }, key: string): boolean {
  if (key !== "Enter" && key !== " ") return false;
  return localName === "button" || localName === "summary" || (localName === "input" && ["color", "file"].includes(type ?? ""));
}

/** Returns whether the focused element handles the key itself: Enter and Space on a button, arrows on a slider. */
function ownsKey({ target, key, ctrlKey, metaKey, altKey }: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement) || target === document.body || ctrlKey || metaKey || altKey) return false;
  if (key === "Enter") return isPressedBy(target, key);
  return [" ", "Tab", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"].includes(key);
}
