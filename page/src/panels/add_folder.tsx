import { useState } from "preact/hooks";
import type { Page } from "../app/page";
import { sentence, toldOf, type Failure } from "../app/wording";
import { Button } from "./ui/button";

/** A button that asks for the path of another folder to use. */
export function AddFolder({ page, onAdded }: { page: Page; onAdded: (folder: string) => void }) {
  const [typed, setTyped] = useState<string | null>(null);
  const [failure, setFailure] = useState<Failure | undefined>(undefined);
  const close = () => {
    setTyped(null);
    setFailure(undefined);
  };
  if (typed === null)
    return (
      <Button label="Add a folder…" icon="plus" kind="quiet" class="add-folder" onClick={() => setTyped("")} />
    );
  const add = async () => {
    if (typed.trim() === "") return;
    const answer = await page.editor.folders.add(typed.trim());
    if (typeof answer !== "string") return setFailure(answer);
    close();
    page.editor.announce(`The folder ${answer} is added.`);
    onAdded(answer);
  };
  return (
    <form
      class="add-folder"
      onSubmit={(event) => {
        event.preventDefault();
        void add();
      }}
      onKeyDown={(event) => {
        if (event.key !== "Escape") return;
        event.stopPropagation();
        close();
      }}
    >
      <input
        type="text"
        aria-label="Path of the folder"
        placeholder="/home/me/models or ~/models"
        value={typed}
        autoFocus
        spellcheck={false}
        onInput={(event) => {
          setTyped(event.currentTarget.value);
          setFailure(undefined);
        }}
      />
      <Button label="Add" disabled={typed.trim() === ""} onClick={() => void add()} />
      <Button label="Cancel" kind="quiet" onClick={close} />
      {failure !== undefined && (
        <p class="failure" role="alert">
          {sentence(toldOf(failure).problem)}. {toldOf(failure).remedy}
        </p>
      )}
    </form>
  );
}
