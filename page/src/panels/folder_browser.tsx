import { useEffect, useState } from "preact/hooks";
import { isFoundBy } from "../app/own_models";
import type { Page } from "../app/page";
import { compareNames, baseName, folderOf, joined } from "../app/paths";
import { formatBytes } from "../app/units";
import { AddFolder } from "./add_folder";
import { Thumbnail } from "./graft/thumbnail";
import { IconButton } from "./ui/button";
import { Icon } from "./ui/icon";

export interface Entry {
  name: string;
  kind: "model" | "edit";
  bytes: number;
  /** Whether a session left unsaved changes or has the file open. */
  unsaved: boolean;
}

export interface Listing {
  folder: string | null;
  folders: string[];
  files: Entry[];
}

/** Returns the content of a folder; undefined until the engine answers or if it cannot be read. */
export function useListing(page: Page, folder: string | null): Listing | undefined {
  const [read, setRead] = useState<{ of: string | null; listing: Listing } | undefined>(undefined);
  useEffect(() => {
    let wanted = true;
    void page.editor.ask(folder === null ? { do: "list" } : { do: "list", folder }).then((outcome) => {
      if (!wanted || outcome === undefined) return;
      const files = (outcome.files ?? []).filter((file) => typeof file !== "string");
      const folders = [...(outcome.folders ?? [])].sort(compareNames);
      const listing = { folder: outcome.folder ?? null, folders, files: files.sort((a, b) => compareNames(a.name, b.name)) };
      setRead({ of: folder, listing });
    });
    return () => {
      wanted = false;
    };
  }, [folder, page.editor.filesWritten.value]);
  return read?.of === folder ? read.listing : undefined;
}

interface BrowserProps {
  page: Page;
  folder: string | null;
  onFolder: (folder: string | null) => void;
  listing: Listing | undefined;
  /** Absent: files are shown but cannot be chosen. */
  onFile?: (path: string, entry: Entry) => void;
  shows?: (entry: Entry) => boolean;
  /** Shows pictures of the models. */
  pictures?: boolean;
  /** What a field elsewhere searches for. Absent: the list has a field of its own. */
  searched?: string;
}

const mostUnsearched = 8; // entries of a list that needs no search

/** Shows the folders that may be used, and their content. */
export function FolderBrowser({ page, folder, onFolder, listing, onFile, shows, pictures = false, searched }: BrowserProps) {
  const roots = page.editor.welcome.value?.folders ?? [];
  const isRoot = folder === null || roots.includes(folder);
  const [typed, setSearch] = useState("");
  const search = searched ?? typed;
  useEffect(() => setSearch(""), [folder]);
  const allFiles = (listing?.files ?? []).filter((entry) => shows?.(entry) !== false);
  const isFound = isFoundBy(search);
  const allFolders = folder === null ? [...roots].sort(compareNames) : (listing?.folders ?? []);
  const folders = folder === null ? allFolders : allFolders.filter((name) => isFound(baseName(name)));
  const files = allFiles.filter(({ name }) => isFound(name));
  const isEmpty = listing !== undefined && folders.length === 0 && files.length === 0;
  return (
    <div class="browser">
      <div class="browser-path">
        <button
          type="button"
          class="icon-button"
          aria-label="Up one folder"
          disabled={folder === null}
          onClick={() => onFolder(isRoot ? null : folderOf(folder))}
        >
          <Icon name="up" />
        </button>
        <code data-tip={folder ?? ""}>
          {folder === null ? "Folders" : shortened(folder)}
        </code>
      </div>
      {searched === undefined && allFolders.length + allFiles.length > mostUnsearched && (
        <input
          type="search"
          class="browser-search"
          aria-label="Search this folder"
          placeholder="Search this folder"
          value={search}
          onInput={(event) => setSearch(event.currentTarget.value)}
        />
      )}
      <ul class="list browser-list" aria-label="Files">
        {folders.map((name) => (
          <li key={name}>
            <button
              type="button"
              class="list-main"
              onClick={() => onFolder(folder === null ? name : joined(folder, name))}
            >
              <Icon name="folder" size={16} />
              <span class="list-name">{folder === null ? name : baseName(name)}</span>
            </button>
            {folder === null && page.editor.folders.isAdded(name) && (
              <IconButton
                label={`Forget ${name}`}
                icon="close"
                tip="Takes the folder off this list, now and in later sessions."
                onClick={() => page.editor.folders.forget(name)}
              />
            )}
          </li>
        ))}
        {files.map((entry) => (
          <li key={entry.name}>
            <button
              type="button"
              class="list-main"
              disabled={onFile === undefined || folder === null}
              onClick={() => folder !== null && onFile?.(joined(folder, entry.name), entry)}
            >
              {pictures && entry.kind === "model" && folder !== null ? (
                <Thumbnail page={page} of={{ path: joined(folder, entry.name) }} size={28} />
              ) : (
                <Icon name={entry.kind} size={16} />
              )}
              <span class="list-name">{entry.name}</span>
              <small>{entry.unsaved ? "unsaved work" : formatBytes(entry.bytes)}</small>
            </button>
          </li>
        ))}
        {isEmpty && (
          <li class="nothing">
            {folder === null
              ? "There is no folder yet. Add the folder of your models."
              : "No matching files here."}
          </li>
        )}
      </ul>
      <AddFolder page={page} onAdded={onFolder} />
    </div>
  );
}

/** Shortens a long path at the start, because its end is more telling. */
function shortened(path: string): string {
  return path.length <= 44 ? path : `…${path.slice(path.indexOf("/", path.length - 44))}`;
}
