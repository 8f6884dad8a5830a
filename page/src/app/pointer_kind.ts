import { signal } from "@preact/signals";

/** What the user points with. */
export type PointerKind = "mouse" | "touch" | "pen";

/** What the user pointed with last; before the first press, what the browser says is the main one. */
export const pointerKind = signal<PointerKind>(mainPointer());

/** Follows what the user points with. */
export function followPointerKind(): void {
  window.addEventListener("pointerdown", ({ pointerType }) => (pointerKind.value = kindOf(pointerType)), { capture: true });
}

/** Returns a hint for who points with fingers: "tap" in place of "click". */
export function forFingers(hint: string): string {
  if (pointerKind.value !== "touch") return hint;
  return hint.replace(/\bClick\b/g, "Tap").replace(/\bclick\b/g, "tap");
}

export function kindOf(pointerType: string): PointerKind {
  return pointerType === "touch" || pointerType === "pen" ? pointerType : "mouse";
}

function mainPointer(): PointerKind {
  return globalThis.matchMedia?.("(pointer: coarse)").matches === true ? "touch" : "mouse";
}
