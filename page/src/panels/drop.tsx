import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import type { Page } from "../app/page";
import { formatBytes } from "../app/units";
import { refusalOf, Upload } from "../app/upload";
import type { Told } from "../app/wording";
import { Button } from "./ui/button";
import { Dialog } from "./ui/dialog";
import { Icon } from "./ui/icon";

const going = signal<Upload | null>(null);

/** Sends a file of the user's machine to the engine and opens it. Tells the user why a file was refused. */
export async function takeFile(page: Page, file: File): Promise<void> {
  await sendFile(page, file, (upload) => page.editor.open({ do: "open", upload }));
}

/** Sends a file of the user's machine to the engine and adds it as a part beside the model. */
export async function takePartFile(page: Page, file: File): Promise<void> {
  const { graft } = page.editor;
  await sendFile(page, file, async (upload) => {
    graft.mode.value = "graft";
    await graft.addPart({ upload });
  });
}

/** Opens the first file and adds the others as parts. In graft mode all of them become parts. */
async function takeFiles(page: Page, files: readonly File[]): Promise<void> {
  const { editor } = page;
  const asPart = editor.isOpen.value && editor.graft.mode.value === "graft";
  for (const [i, file] of files.entries()) {
    if (i === 0 && !asPart) await takeFile(page, file);
    else if (editor.isOpen.value) await takePartFile(page, file);
  }
}

async function sendFile(page: Page, file: File, then: (upload: string) => Promise<unknown>): Promise<void> {
  const { editor } = page;
  const refusal = refusalOf(file);
  if (refusal !== undefined) return editor.tell("problem", refusal);
  going.value?.cancel();
  const upload = new Upload(file, editor.token);
  going.value = upload;
  try {
    const name = await upload.send();
    if (name !== undefined) await then(name);
  } catch (failure) {
    editor.tell("problem", failure as Told);
  } finally {
    if (going.value === upload) going.value = null;
  }
}

/**
 * Accepts files dropped anywhere on the page. Shows where they can be dropped, and asks before they replace unsaved
 * work.
 */
export function DropZone({ page }: { page: Page }) {
  const [over, setOver] = useState(false);
  const [asked, setAsked] = useState<readonly File[] | null>(null);
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
      const { unsaved, graft } = page.editor;
      const [first] = files;
      if (first === undefined) return;
      const replacesWork = unsaved.value && graft.mode.value !== "graft" && refusalOf(first) === undefined;
      if (replacesWork) setAsked(files);
      else void takeFiles(page, files);
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
    if (asked !== null) void takeFiles(page, asked);
    setAsked(null);
  };
  const save = () => {
    if (asked === null) return;
    page.editor.pendingOpen.value = { name: asked[0]?.name ?? "it", open: () => takeFiles(page, asked) };
    setAsked(null);
    void page.editor.saveThenOpenPending();
  };
  const add = () => {
    page.editor.graft.mode.value = "graft";
    open();
  };
  return (
    <>
      {over && (
        <div class="drop-over">
          <Icon name="upload" size={40} />
          <p>Drop to open</p>
        </div>
      )}
      {asked !== null && (
        <Dialog
          title={`Open ${asked[0]?.name ?? "it"}?`}
          onClose={() => setAsked(null)}
          actions={
            <>
              <Button label="Cancel" kind="quiet" onClick={() => setAsked(null)} />
              <Button label="Add as a part" tip="Adds it beside the model, to graft it." onClick={add} />
              <Button label="Open without saving" onClick={open} />
              <Button label="Save…" kind="primary" onClick={save} />
            </>
          }
        >
          <p>{page.editor.state.value?.name} has unsaved changes.</p>
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
