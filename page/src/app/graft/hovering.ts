// The part that is over the surface during a drop, so that a reload can take it back. Lasts as long as the tab.

const key = "meshgraft hovering";

/** Returns the name of the part; empty if there was none. */
export function name(): string {
  try {
    return sessionStorage.getItem(key) ?? "";
  } catch {
    return "";
  }
}

export function remember(part: string): void {
  store(part);
}

export function forget(): void {
  store("");
}

function store(text: string): void {
  try {
    sessionStorage.setItem(key, text);
  } catch {
    // A browser that stores nothing leaves the part in the document after a reload.
  }
}
