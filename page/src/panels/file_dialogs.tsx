import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { MeshObject } from "../app/graft/graft";
import type { Page } from "../app/page";
import {
  faultOfName,
  folderOf,
  joined,
  meshFormats,
  stemOf,
  withExtension,
  type MeshFormat,
} from "../app/paths";
import { remembered } from "../app/remembered";
import { fileToReplace, sentence, toldOf, type Failure } from "../app/wording";
import { counted, formatSize } from "../app/units";
import type { DocumentState, PageRequest } from "../protocol";
import { FolderBrowser, useListing } from "./folder_browser";
import { printProblems, unitOfFileWords } from "../app/print_words";
import { sidesOf } from "./status_bar";
import { RemedyButton } from "./remedy_button";
import { Button } from "./ui/button";
import { Dialog } from "./ui/dialog";
import { Segments, Select, Toggle } from "./ui/fields";
import { Icon } from "./ui/icon";

type FileRequest = Extract<PageRequest, { do: "save" | "export" }>;

interface TargetProps {
  page: Page;
  title: string;
  done: string;
  action: string;
  extension: string;
  start: { folder: string | null; name: string };
  request: (path: string, overwrite: boolean) => FileRequest;
  onClose: () => void;
  onDone?: () => void;
  children?: preact.ComponentChildren;
}

/** Asks for the folder and name of a file, and confirms before another file is overwritten. */
function TargetDialog(props: TargetProps) {
  const { page, extension, start, onClose } = props;
  const [folder, setFolder] = useState(start.folder);
  const [own, setOwn] = useState<string | null>(null); // replaces the suggestion once something is typed
  const typed = own ?? start.name;
  const [failure, setFailure] = useState<Failure | undefined>(undefined);
  const [asks, setAsks] = useState(false);
  const [busy, setBusy] = useState(false);
  // Before the next event: an effect after the next frame would undo what Enter asked for meanwhile.
  useLayoutEffect(() => {
    setAsks(false);
    setFailure(undefined);
  }, [extension, typed, folder]);
  const listing = useListing(page, folder);
  const name = withExtension(typed.trim(), extension);
  const fault = folder === null ? "Choose a folder." : faultOfName(typed);
  const told = failure === undefined ? undefined : toldOf(failure);
  const exists = listing?.files.some((file) => file.name === name) === true;
  const write = async (overwrite: boolean) => {
    if (fault !== undefined || folder === null) return;
    if (exists && !overwrite) return setAsks(true);
    setBusy(true);
    setFailure(undefined);
    const answer = await page.editor.attempt(props.request(joined(folder, name), overwrite));
    setBusy(false);
    setAsks(false);
    if ("code" in answer)
      return fileToReplace(answer) !== undefined ? setAsks(true) : setFailure(answer);
    if (props.onDone === undefined) onClose();
    page.editor.tellFiles(props.done, answer);
    props.onDone?.();
  };
  const actions = asks ? (
    <>
      <p class="question">
        <strong>{name}</strong> already exists. Replace it?
      </p>
      <Button label="Don't replace" kind="quiet" onClick={() => setAsks(false)} />
      <Button label="Replace" kind="danger" onClick={() => void write(true)} />
    </>
  ) : (
    <>
      <Button label="Cancel" kind="quiet" onClick={onClose} />
      <Button
        label={props.action}
        kind="primary"
        disabled={fault !== undefined || busy}
        onClick={() => void write(false)}
      />
    </>
  );
  return (
    <Dialog title={props.title} onClose={onClose} actions={actions} wide>
      {props.children}
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void write(false);
        }}
      >
        <label class="row file-name-row">
          <span>Name</span>
          <input
            type="text"
            value={typed}
            autoFocus
            onFocus={(event) => event.currentTarget.select()}
            onInput={(event) => setOwn(event.currentTarget.value)}
          />
          <span class="suffix">{withExtension("", extension)}</span>
        </label>
      </form>
      <FolderBrowser
        page={page}
        folder={folder}
        onFolder={setFolder}
        listing={listing}
        onFile={(path) => setOwn(stemOf(path))}
        shows={(entry) => entry.name.endsWith(extension)}
      />
      {fault !== undefined && <p class="hint">{fault}</p>}
      {told !== undefined && (
        <p class="failure" role="alert" data-fact={failure !== undefined && "id" in failure ? failure.id : undefined}>
          {sentence(told.problem)}. {told.remedy} {told.location !== "" && <code>{told.location}</code>}{" "}
          {failure !== undefined && "id" in failure && <RemedyButton page={page} fact={failure} />}
        </p>
      )}
    </Dialog>
  );
}

function firstFolder(page: Page): string | null {
  const { state, welcome, openedFolder } = page.editor;
  const edit = state.value?.edit ?? "";
  return edit !== "" ? folderOf(edit) : (openedFolder ?? welcome.value?.folders[0] ?? null);
}

/** Saves the edit file, which holds the steps but not the mesh. */
export function SaveDialog({ page, onClose }: { page: Page; onClose: () => void }) {
  const { editor } = page;
  const state = editor.state.value;
  const name =
    state === null || state.edit === "" ? `${stemOf(state?.name ?? "model")}_edit` : stemOf(state.edit);
  return (
    <TargetDialog
      page={page}
      title="Save the edit file"
      done="Saved"
      action="Save"
      extension=".json"
      start={{ folder: firstFolder(page), name }}
      request={(edit, overwrite) => ({ do: "save", edit, overwrite })}
      onDone={() => {
        onClose();
        editor.openPending();
      }}
      onClose={() => {
        onClose();
        editor.pendingOpen.value = null;
      }}
    >
      <p class="hint">
        An edit file stores all your steps, so that you can continue or repeat them later. The model's own file
        is not changed.
      </p>
    </TargetDialog>
  );
}

/** Returns the suggested name of an exported mesh: the part's, that of the edit file, or else the model's with an ending. */
export function exportName(state: Pick<DocumentState, "name" | "edit"> | null, part = ""): string {
  if (part !== "") return part.replace(/\s+/g, "_");
  if (state !== null && state.edit !== "") return stemOf(state.edit);
  return `${stemOf(state?.name ?? "model")}_edited`;
}

interface ContentProps {
  page: Page;
  extension: string;
  /** The part to export; undefined for the model. */
  part: MeshObject | undefined;
}

/** Says what the exported file will hold, and what a printer would not take. */
function Content({ page, extension, part }: ContentProps) {
  const { state, view, printing } = page.editor;
  const box = part === undefined ? page.shownBox.value : page.graft.boxOf(part.mesh);
  const unit = view.unit.value;
  const faces = part?.faces ?? state.value?.model.faces ?? 0;
  const isOfObject = printing.checked()?.name === part?.name;
  const check = isOfObject ? printing.result.value : null;
  const isUnchecked = check === null;
  const mostFaces = printing.mostFacesUnasked.value;
  useEffect(() => {
    if (!isOfObject) printing.choose(part?.name ?? "");
    if (isUnchecked && faces > 0 && faces <= mostFaces) void printing.check();
  }, [isUnchecked, part?.name]);
  if (state.value === null || box === null) return null;
  const limits = { leastWall: printing.leastWall.value, overhangDeg: printing.overhangDeg.value, unit };
  const problems = check === null ? [] : printProblems(check, limits).filter(({ tone, finding }) => tone === "bad" || finding === "thin-walls");
  const { words, isOther } = unitOfFileWords(extension, state.value.unit, unit);
  const noUnit = unit === "none" && words.startsWith("The file names") ? " The model has no unit: choose one under View." : "";
  return (
    <>
      <p class="hint">{`${counted(faces, "face")}, ${formatSize(sidesOf(box), unit)}. ${isOther ? "" : words}${noUnit}`}</p>
      {isUnchecked && faces > mostFaces && (
        <p class="hint">
          This large mesh is not checked yet for what printers refuse. <Button label="Check" onClick={() => void printing.check()} />
        </p>
      )}
      {(isOther || problems.length > 0) && (
        <ul class="export-warnings" aria-label="Warnings">
          {isOther && <ExportWarning words={words} />}
          {problems.map((line) => (
            <ExportWarning key={line.words} words={line.words} />
          ))}
        </ul>
      )}
    </>
  );
}

function ExportWarning({ words }: { words: string }) {
  return (
    <li>
      <Icon name="warning" size={14} /> {words}
    </li>
  );
}

/** Writes the deformed mesh to a file of its own. */
export function ExportDialog({ page, onClose }: { page: Page; onClose: () => void }) {
  const { graft, state: document, toExport } = page.editor;
  const state = document.value;
  const part = graft.parts.value.find(({ name }) => name === toExport.value);
  const extension = remembered("export format", ".ply");
  const format =
    meshFormats.find((one) => one.extension === extension.value) ?? (meshFormats[0] as MeshFormat);
  const [isMorph, setMorph] = useState(false);
  const [morphName, setMorphName] = useState("edit");
  const asMorph = isMorph && format.morphTargets === true;
  return (
    <TargetDialog
      page={page}
      title="Export the mesh"
      done="Exported"
      action="Export"
      extension={format.extension}
      start={{ folder: firstFolder(page), name: exportName(state, part?.name) }}
      request={(path, overwrite) => ({
        do: "export",
        path,
        overwrite,
        ...(part !== undefined && { mesh: part.name }),
        ...(asMorph
          ? { as: "morph-target", name: morphName.trim() === "" ? "edit" : morphName.trim() }
          : { as: "mesh" }),
      })}
      onClose={onClose}
    >
      {graft.parts.value.length > 0 && (
        <Select
          label="Object"
          value={part?.name ?? ""}
          choices={[
            { value: "", label: `${state?.model.name ?? ""} (the model)` },
            ...graft.parts.value.map(({ name }) => ({ value: name, label: name })),
          ]}
          onChange={(to) => (toExport.value = to)}
        />
      )}
      <Select
        label="Format"
        value={format.extension}
        choices={meshFormats.map((one) => ({
          value: one.extension,
          label: `${one.label} (${one.extension})`,
        }))}
        onChange={(to) => (extension.value = to)}
      />
      <p class="hint">{format.keeps}</p>
      {!asMorph && !graft.isEdited.value && <Content page={page} extension={format.extension} part={part} />}
      {graft.isEdited.value && <p class="hint">The file has the graft as it is now. Accept it first to have the mesh checked.</p>}
      {format.morphTargets === true && (
        <Toggle
          label="As a morph target"
          value={isMorph}
          help="Keeps the original shape and adds the edit as a morph target (shape key)."
          onChange={setMorph}
        />
      )}
      {asMorph && (
        <label class="row">
          <span>Name of the morph target</span>
          <input type="text" value={morphName} onInput={(event) => setMorphName(event.currentTarget.value)} />
        </label>
      )}
    </TargetDialog>
  );
}

/** Opens another model in place of the current one. */
export function OpenDialog({ page, onClose }: { page: Page; onClose: () => void }) {
  const { editor } = page;
  const welcome = editor.welcome.value;
  const [folder, setFolder] = useState<string | null>(welcome?.folders[0] ?? null);
  const [source, setSource] = useState<"files" | "samples">(
    welcome?.folders.length === 0 ? "samples" : "files",
  );
  const listing = useListing(page, folder);
  const body = useRef<HTMLDivElement>(null);
  const isListed = listing !== undefined;
  useEffect(() => body.current?.querySelector<HTMLElement>(".browser-list button")?.focus(), [isListed, source]);
  return (
    <Dialog title="Open" onClose={onClose} wide>
      <div ref={body}>
        <Segments
          label="From"
          hideLabel
          value={source}
          choices={[
            { value: "files", label: "Files" },
            { value: "samples", label: "Samples" },
          ]}
          onChange={setSource}
        />
        {source === "files" && (
          <FolderBrowser
            page={page}
            folder={folder}
            onFolder={setFolder}
            listing={listing}
            pictures
            onFile={(path) => editor.openInstead({ do: "open", path })}
          />
        )}
        {source === "samples" && (
          <ul class="list browser-list" aria-label="Samples">
            {(welcome?.samples ?? []).map(({ name, description }) => (
              <li key={name}>
                <button
                  type="button"
                  class="list-main"
                  onClick={() => editor.openInstead({ do: "open", sample: name })}
                >
                  <span class="list-name">{name}</span>
                  <small>{description}</small>
                </button>
              </li>
            ))}
          </ul>
        )}
        <p class="hint">Or drop a file anywhere on the page.</p>
      </div>
    </Dialog>
  );
}
