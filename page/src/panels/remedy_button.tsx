import type { Page } from "../app/page";
import { remedyOf } from "../app/remedies";
import type { PageRequest } from "../protocol";
import { Button } from "./ui/button";

/** A button for what the page can do about a fact; nothing if it can do nothing. */
export function RemedyButton({ page, fact, refused }: { page: Page; fact: { id: string; fields: object }; refused?: PageRequest }) {
  const remedy = remedyOf(fact, refused);
  if (remedy === undefined) return null;
  return <Button label={remedy.label} onClick={() => void remedy.run(page.editor)} />;
}
