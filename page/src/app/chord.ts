/** The fields of a keyboard event that say which keys are down. */
export interface KeyPress {
  key: string;
  code: string;
  ctrlKey: boolean;
  metaKey: boolean;
  shiftKey: boolean;
  altKey: boolean;
  getModifierState?(name: string): boolean;
}

/** Keys pressed together. `key` is a capital letter, the character printed on the key, or "Num0" … "Num9". */
export interface Chord {
  readonly ctrl: boolean;
  readonly shift: boolean;
  readonly alt: boolean;
  readonly key: string;
}

/** Parses text such as "ctrl+shift+Z". A trailing plus is the key itself: "ctrl++". Throws if the text names no key. */
export function parseChord(text: string): Chord {
  const key = text.endsWith("+") ? "+" : text.slice(text.lastIndexOf("+") + 1);
  const before = text.slice(0, text.length - key.length).split("+").filter((part) => part !== "");
  const unknown = before.find((part) => !["ctrl", "shift", "alt"].includes(part));
  if (key === "" || unknown !== undefined) throw new Error(`"${text}" names no keys`);
  return { ctrl: before.includes("ctrl"), shift: before.includes("shift"), alt: before.includes("alt"), key };
}

/** Returns the chord of a key press, the same on every keyboard. The command key of a Mac counts as ctrl. */
export function chordOf(press: KeyPress): Chord {
  const key = keyOf(press);
  // AltGr reports ctrl and alt, but only selects a character. So does shift if the key is not a letter ("?", "+").
  // Neither counts as a modifier of the chord.
  const altGraph = press.getModifierState?.("AltGraph") === true;
  const ownShift = key.length === 1 && key.toLowerCase() === key.toUpperCase();
  return {
    ctrl: (press.ctrlKey && !altGraph) || press.metaKey,
    shift: press.shiftKey && !ownShift,
    alt: press.altKey && !altGraph,
    key,
  };
}

export function matches(chord: Chord, press: KeyPress): boolean {
  const pressed = chordOf(press);
  return (
    chord.key === pressed.key &&
    chord.ctrl === pressed.ctrl &&
    chord.shift === pressed.shift &&
    chord.alt === pressed.alt
  );
}

/** Formats a chord for buttons: "Ctrl+Shift+Z", "Num 1". */
export function chordLabel(text: string): string {
  const { ctrl, shift, alt, key } = parseChord(text);
  const names: Record<string, string> = { Escape: "Esc", Delete: "Del", " ": "Space" };
  const shown = names[key] ?? key.replace(/^Num(?=\d)/, "Num ");
  return [ctrl && "Ctrl", alt && "Alt", shift && "Shift", shown].filter((part) => part !== false).join("+");
}

function keyOf({ key, code, altKey, metaKey, ctrlKey }: KeyPress): string {
  const digit = /^Numpad(\d)$/.exec(code)?.[1];
  if (digit !== undefined) return `Num${digit}`;
  // On some systems modifiers change the character that a letter's key types.
  const letter = /^Key([A-Z])$/.exec(code)?.[1];
  const isLetter = key.length === 1 && key.toLowerCase() !== key.toUpperCase();
  if (letter !== undefined && (altKey || metaKey || ctrlKey) && !/^[a-z]$/i.test(key)) return letter;
  return isLetter ? key.toUpperCase() : key;
}
