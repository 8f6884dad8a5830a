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

/** Changes a remembered signal from what the browser has stored last, so that nothing of another tab is lost. */
export function changeRemembered<Value>(name: string, change: (stored: Value) => Value): void {
  const kept = known.get(name) as Signal<Value> | undefined;
  if (kept !== undefined) kept.value = change(read(name, kept.value));
}

/**
 * A list of texts that the browser stores, in the order in which they were added. Each has a key of its own, so that
 * tabs that change the list at the same time lose nothing.
 */
export class RememberedList {
  readonly items: Signal<readonly string[]>;

  constructor(private readonly name: string) {
    this.items = signal(this.read());
  }

  add(item: string): void {
    this.store(() => localStorage.setItem(this.keyOf(item), String(Date.now())));
    this.items.value = [...this.items.value.filter((one) => one !== item), item];
  }
  remove(item: string): void {
    this.store(() => localStorage.removeItem(this.keyOf(item)));
    this.items.value = this.items.value.filter((one) => one !== item);
  }

  /** Calls `then` whenever another tab has changed the list. */
  followOtherTabs(then: () => void): void {
    window.addEventListener("storage", (event) => {
      if (event.key?.startsWith(this.keyOf("")) !== true) return;
      this.items.value = this.read();
      then();
    });
  }

  private keyOf(item: string): string {
    return key(`${this.name} ${item}`);
  }
  private store(change: () => void): void {
    try {
      change();
    } catch {
      // A browser that stores nothing forgets the list.
    }
  }
  private read(): string[] {
    const found: [string, number][] = [];
    this.store(() => {
      for (let i = 0; i < localStorage.length; ++i) {
        const stored = localStorage.key(i) ?? "";
        if (!stored.startsWith(this.keyOf(""))) continue;
        found.push([stored.slice(this.keyOf("").length), Number(localStorage.getItem(stored))]);
      }
    });
    return found.sort(([a, x], [b, y]) => x - y || (a < b ? -1 : 1)).map(([item]) => item);
  }
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
