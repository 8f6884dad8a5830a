import type { Page } from "../app/page";

/** Reads out what an act has come to, for those who do not see the view. */
export function Announcer({ page }: { page: Page }) {
  return (
    <div class="hidden" role="status" aria-live="polite" aria-label="What was done">
      {page.editor.announced.value}
    </div>
  );
}
