import { effect, signal, type Signal } from "@preact/signals";

const known = new Map<string, Signal<unknown>>();

/** Returns a signal that the browser stores if it is allowed to. There is one signal for each name. */
export function remembered<Value>(name: string, defaultValue: Value): Signal<Value> {
  const before = known.get(name);
  if (before !== undefined) return before as Signal<Value>;
  const made = signal<Value>(read(name, defaultValue));
  effect(() => write(name, made.value));
  known.set(name, made as Signal<unknown>);
  return made;
}

function key(name: string): string {
  return `meshgraft ${name}`;
}

function read<Value>(name: string, defaultValue: Value): Value {
  try {
    const text = localStorage.getItem(key(name));
    const value: unknown = text === null ? defaultValue : JSON.parse(text);
    return typeof value === typeof defaultValue ? (value as Value) : defaultValue;
  } catch {
    return defaultValue;
  }
}

function write(name: string, value: unknown): void {
  try {
    localStorage.setItem(key(name), JSON.stringify(value));
  } catch {
    // A browser that stores nothing starts with the default settings each time.
  }
}

/** Lets the browser store signals by their names. Used only for settings of the user. */
export function rememberSettings(
  settings: Readonly<Record<string, Signal<string> | Signal<boolean> | Signal<Readonly<Record<string, string>>>>>,
): void {
  for (const [name, setting] of Object.entries(settings)) {
    const kept = setting as Signal<unknown>;
    kept.value = read(`setting ${name}`, kept.value);
    effect(() => write(`setting ${name}`, kept.value));
  }
}

/** Takes over a setting as soon as another tab stores it, so that neither tab overwrites what the other one stored. */
export function followOtherTabs(name: string, setting: Signal<Readonly<Record<string, string>>>): void {
  window.addEventListener("storage", (event) => {
    if (event.key === key(`setting ${name}`)) setting.value = read(`setting ${name}`, setting.value);
  });
}
