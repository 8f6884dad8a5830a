import type { Viewport } from "../view/viewport";
import type { Editor } from "./editor";
import type { Command } from "./keys";

/** What every panel gets. */
export interface Page {
  readonly editor: Editor;
  readonly viewport: Viewport;
  readonly commands: readonly Command[];
  /** Puts the view, and the tools on it, into an element. */
  attach(host: HTMLElement): void;
}

/** The command of this name. Throws where the table has none. */
export function commandOf(page: Page, id: string): Command {
  const found = page.commands.find((command) => command.id === id);
  if (found === undefined) throw new Error(`there is no command ${id}`);
  return found;
}
