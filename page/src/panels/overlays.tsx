import { useEffect, useLayoutEffect } from "preact/hooks";
import type { Page } from "../app/page";
import { baseName } from "../app/paths";
import { changeLabel } from "../app/request_labels";
import { counted } from "../app/units";
import { Button } from "./ui/button";
import { Dialog } from "./ui/dialog";
import { Icon } from "./ui/icon";

/** Offers to restore the changes of a session that ended without saving. */
export function RestoreOffer({ page }: { page: Page }) {
  const { editor } = page;
  const offer = editor.offer.value;
  if (offer === null) return null;
  const restore = () => {
    editor.offer.value = null;
    void editor.ask({ do: "restore" });
  };
  const putAside = async () => {
    editor.offer.value = null;
    const done = await editor.ask({ do: "discard" });
    if (done?.aside === undefined) return;
    const ending = done.aside.slice(done.aside.lastIndexOf("."));
    editor.note(
      "The earlier changes were set aside, not deleted.",
      done.aside,
      `To get them back, take “${ending}” off the file's name, and open the model again before you change it.`,
    );
  };
  return (
    <Dialog
      title="Restore unsaved work?"
      actions={
        <>
          <Button label="Don't restore" tip="Sets the changes aside in a file. They are not deleted." kind="quiet" onClick={() => void putAside()} />
          <Button label="Restore" kind="primary" autoFocus onClick={restore} />
        </>
      }
    >
      <p>
        An earlier session on {editor.state.value?.name ?? "this model"} ended before it was saved. It
        left <strong>{counted(offer.changes, "change")}</strong>
        {offer.last !== null && <> (the last: {changeLabel(offer.last)})</>}
        {offer.undone > 0 && <>, and {counted(offer.undone, "undone change")} to redo</>}.
      </p>
    </Dialog>
  );
}

/** Asks what to do with unsaved work before another document replaces it. */
export function LeaveQuestion({ page }: { page: Page }) {
  const { editor } = page;
  const pending = editor.pendingOpen.value;
  if (pending === null || editor.dialog.value === "save" || editor.replacing.value !== null) return null;
  const name = baseName(editor.state.value?.name ?? "What is open");
  return (
    <Dialog
      title={`Open ${pending.name}?`}
      onClose={() => (editor.pendingOpen.value = null)}
      actions={
        <>
          <Button label="Cancel" kind="quiet" onClick={() => (editor.pendingOpen.value = null)} />
          <Button
            label="Open without saving"
            tip={`The changes stay in a session file beside ${name}. You can restore them when you open it again.`}
            onClick={() => editor.openPending()}
          />
          <Button label="Save…" kind="primary" autoFocus onClick={() => void editor.saveThenOpenPending()} />
        </>
      }
    >
      <p>
        {name} has unsaved changes. If you do not save them, they stay in a session file beside it, and you can
        restore them when you open it again.
      </p>
    </Dialog>
  );
}

/** Asks before an edit file is overwritten that another tab or program has changed. */
export function ReplaceQuestion({ page }: { page: Page }) {
  const { editor } = page;
  const file = editor.replacing.value;
  if (file === null) return null;
  const cancel = () => (editor.replacing.value = editor.pendingOpen.value = null);
  const saveAs = () => {
    editor.replacing.value = null;
    editor.dialog.value = "save";
  };
  return (
    <Dialog
      title={`${baseName(file)} was changed elsewhere`}
      onClose={cancel}
      actions={
        <>
          <Button label="Don't save" kind="quiet" onClick={cancel} />
          <Button label="Replace" kind="danger" onClick={() => void editor.replace()} />
          <Button label="Save as…" kind="primary" autoFocus onClick={saveAs} />
        </>
      }
    >
      <p>
        Another tab or another program has written <strong>{file}</strong> since it was opened or saved here.
        Replacing it loses what it contains now.
      </p>
    </Dialog>
  );
}

/** Shown while the engine does not answer. */
export function LostConnection({ page }: { page: Page }) {
  const { editor } = page;
  const lost = editor.link.value === "lost";
  if (!lost || !(editor.expired.value || editor.welcome.value !== null)) return null;
  const program = editor.isWaitedFor.value ? "the program that opened this page" : "the program";
  const isSafe =
    editor.state.value === null
      ? ""
      : editor.isWaitedFor.value
        ? "It has all changes that you made here."
        : "Your work is safe: every change is saved to disk as you make it.";
  return (
    <div class="lost" role="alertdialog" aria-label="The connection is lost">
      <div class="lost-card">
        <Icon name="warning" size={30} />
        {editor.token === "" ? (
          <>
            <h2>The address is incomplete</h2>
            <p>
              Its token is missing. Open the whole address that the program printed when it started.
            </p>
          </>
        ) : editor.expired.value ? (
          <>
            <h2>meshgraft was restarted</h2>
            <p>
              This page belongs to the previous run. Open the new address that the program printed. {isSafe}
            </p>
            {editor.state.value !== null && (
              <p>Open {editor.state.value.name} there to restore what was not saved.</p>
            )}
          </>
        ) : (
          <>
            <h2>meshgraft does not answer</h2>
            <p>
              Check that {program} is still running. This page reconnects by itself; if you restart the program, open
              the address that it prints. {isSafe}
            </p>
            <span class="bar unknown" role="progressbar" aria-label="Reconnecting">
              <i />
            </span>
          </>
        )}
      </div>
    </div>
  );
}

/** Shown when the work is done and the program that waited for it has it. */
export function HandedBack({ page }: { page: Page }) {
  const { editor } = page;
  if (!editor.handedBack.value) return null;
  return (
    <div class="lost" role="alertdialog" aria-label="Done">
      <div class="lost-card">
        <Icon name="accept" size={30} />
        <h2>Done</h2>
        <p>The program that opened this page has the mesh and the edit. You can close the page.</p>
      </div>
    </div>
  );
}

/** Sets the title and theme of the page, and asks before the page is left with unsaved work. */
export function PageEffects({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const unsaved = editor.unsaved.value;
  const theme = editor.view.theme.value;
  useLayoutEffect(() => {
    document.title = state === null ? "meshgraft" : `${unsaved ? "● " : ""}${state.name} – meshgraft`;
  }, [state?.name, unsaved]);
  useEffect(() => {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const apply = () => {
      document.documentElement.dataset["theme"] =
        theme === "system" ? (dark.matches ? "dark" : "light") : theme;
    };
    apply();
    dark.addEventListener("change", apply);
    return () => dark.removeEventListener("change", apply);
  }, [theme]);
  useEffect(() => {
    const ask = (event: BeforeUnloadEvent) => {
      if (!editor.unsaved.value) return;
      event.preventDefault();
      event.returnValue = true; // some browsers ask only with a value
    };
    window.addEventListener("beforeunload", ask);
    return () => window.removeEventListener("beforeunload", ask);
  }, [editor]);
  return null;
}
