import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import type { Page } from "../app/page";
import { formatBytes } from "../app/units";
import { refusalOf, Upload } from "../app/upload";
import type { EngineError } from "../protocol";
import { Button } from "./ui/button";
import { Dialog } from "./ui/dialog";
import { Icon } from "./ui/icon";

const going = signal<Upload | null>(null);

/** Sends a file of this machine to the engine and opens it; refused ones are explained. */
export async function takeFile(page: Page, file: File): Promise<void> {
  const { editor } = page;
  const refusal = refusalOf(file);
  if (refusal !== undefined) return editor.tell("problem", refusal);
  going.value?.cancel();
  const upload = new Upload(file, editor.token);
  going.value = upload;
  try {
    const name = await upload.send();
    if (name !== undefined) await editor.open({ do: "open", upload: name });
  } catch (failure) {
    editor.tell("problem", failure as EngineError);
  } finally {
    if (going.value === upload) going.value = null;
  }
}

/** A file may be dropped anywhere: shows so, and asks before it takes the place of unsaved work. */
export function DropZone({ page }: { page: Page }) {
  const [over, setOver] = useState(false);
  const [asked, setAsked] = useState<File | null>(null);
  useEffect(() => {
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") === true;
    const enter = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      setOver(true);
    };
    const leave = (event: DragEvent) => event.relatedTarget === null && setOver(false);
    const drop = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      setOver(false);
      const files = [...(event.dataTransfer?.files ?? [])];
      const [file] = files;
      if (files.length > 1) page.editor.note("Only the first of these files is opened.", "", "Drop one file at a time.");
      if (file === undefined) return;
      if (page.editor.state.value?.dirty === true) setAsked(file);
      else void takeFile(page, file);
    };
    window.addEventListener("dragenter", enter);
    window.addEventListener("dragover", enter);
    window.addEventListener("dragleave", leave);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragenter", enter);
      window.removeEventListener("dragover", enter);
      window.removeEventListener("dragleave", leave);
      window.removeEventListener("drop", drop);
    };
  }, [page]);
  const open = () => {
    if (asked !== null) void takeFile(page, asked);
    setAsked(null);
  };
  return (
    <>
      {over && (
        <div class="drop-over">
          <Icon name="upload" size={40} />
          <p>Drop it to open it</p>
        </div>
      )}
      {asked !== null && (
        <Dialog
          title={`Open ${asked.name}?`}
          onClose={() => setAsked(null)}
          actions={
            <>
              <Button label="Stay here" kind="quiet" onClick={() => setAsked(null)} />
              <Button label="Open it" kind="primary" onClick={open} />
            </>
          }
        >
          <p>{page.editor.state.value?.name} has changes that are not saved.</p>
        </Dialog>
      )}
      <UploadBar />
    </>
  );
}

function UploadBar() {
  const upload = going.value;
  if (upload === null) return null;
  const fraction = upload.fraction.value;
  return (
    <div class="upload" role="status">
      <Icon name="upload" />
      <div>
        <strong>{upload.file.name}</strong>
        <small>
          {fraction < 1 ? `${Math.round(100 * fraction)} % of ${formatBytes(upload.file.size)}` : "Opening…"}
        </small>
        <progress max={1} value={fraction} aria-label={`Upload of ${upload.file.name}`} />
      </div>
      <Button label="Cancel" kind="quiet" onClick={() => upload.cancel()} />
    </div>
  );
}
