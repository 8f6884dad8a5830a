type Input = "pointer" | "step" | "key";

/**
 * Remembers which elements have the focus because of a click. Enter and Space do not press these again, because the user
 * means what the keys do in the editor. An element that Tab or the arrows step to is pressed as usual.
 */
export class ClickedElements {
  private readonly clicked = new WeakSet<EventTarget>();
  private last: Input = "key";

  has(element: EventTarget): boolean {
    return this.clicked.has(element);
  }

  notePointer(): void {
    this.last = "pointer";
  }
  noteKey(key: string): void {
    this.last = key === "Tab" || key.startsWith("Arrow") ? "step" : "key";
  }
  /** Notes that an element has the focus after a click by the pointer. The keyboard clicks, too. */
  noteClick(focused: EventTarget | null): void {
    if (focused !== null && this.last === "pointer") this.clicked.add(focused);
  }
  /** Notes that an element got the focus. If a dialog gave it back, what was known of the element remains. */
  noteFocus(element: EventTarget | null): void {
    if (element === null) return;
    if (this.last === "pointer") this.clicked.add(element);
    if (this.last === "step") this.clicked.delete(element);
  }

  /** Listens on the page. Returns a function that removes the listeners. */
  listen(): () => void {
    const all: [string, (event: Event) => void][] = [
      ["pointerdown", () => this.notePointer()],
      ["keydown", (event) => this.noteKey((event as KeyboardEvent).key)],
      ["click", () => this.noteClick(document.activeElement)],
      ["focusin", ({ target }) => this.noteFocus(target)],
    ];
    for (const [name, listener] of all) window.addEventListener(name, listener, true);
    return () => {
      for (const [name, listener] of all) window.removeEventListener(name, listener, true);
    };
  }
}
