import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import type { OpenRequest } from "../app/editor";
import { ownModels, type OwnFiles } from "../app/own_models";
import type { Page } from "../app/page";
import { baseName, folderOf, joined } from "../app/paths";
import { recentIn, wasLeftUnsaved } from "../app/recent";
import { Thumbnail } from "./graft/thumbnail";
import { Button } from "./ui/button";
import { Icon } from "./ui/icon";

const mostUnasked = 10; // own models that are shown at once

/** The user's own models and edit files that are found. */
export interface FoundModels {
  readonly paths: readonly string[];
  readonly recent: readonly string[];
  readonly unsaved: ReadonlySet<string>;
}

/** Returns the user's own models and edit files whose names are found, in the order in which they are shown. */
export function useOwnModels(page: Page, isFound: (name: string) => boolean): FoundModels {
  const welcome = page.editor.welcome.value;
  const folders = welcome?.folders ?? [];
  const files = useFilesOf(page, folders);
  const recent = recentIn(folders, []);
  return {
    paths: ownModels(recent, welcome?.models ?? [], files, isFound),
    recent,
    unsaved: new Set(files.files.filter((file) => file.unsaved).map(({ path }) => path)),
  };
}

/** Opens a model. Who works by keys goes on in the view, because the card or field that has the focus disappears. */
export async function openFromStart(page: Page, request: OpenRequest, byKeys: boolean): Promise<void> {
  if ((await page.editor.open(request)) && byKeys) page.viewport.canvas.focus();
}

/** The models and edit files of the user as large cards, those that were opened last first. */
export function OwnModels({ page, own: { paths, recent, unsaved } }: { page: Page; own: FoundModels }) {
  const [all, setAll] = useState(false);
  const list = useRef<HTMLUListElement>(null);
  useLayoutEffect(() => {
    if (all) list.current?.children[mostUnasked]?.querySelector("button")?.focus(); // the button that had it is gone
  }, [all]);
  if (paths.length === 0) return null;
  const shown = all ? paths : paths.slice(0, mostUnasked);
  return (
    <>
      <h2>Your models</h2>
      <ul class="cards large" aria-label="Your models" ref={list}>
        {shown.map((path) => (
          <Card
            key={path}
            page={page}
            request={{ do: "open", path }}
            name={baseName(path)}
            detail={recent.includes(path) ? `Recent, in ${baseName(folderOf(path))}` : baseName(folderOf(path))}
            tip={path}
            unsaved={unsaved.has(path)}
            size={112}
          />
        ))}
      </ul>
      {shown.length < paths.length && (
        <Button label={`Show all ${paths.length}`} kind="quiet" onClick={() => setAll(true)} />
      )}
    </>
  );
}

type Sample = NonNullable<Page["editor"]["welcome"]["value"]>["samples"][number];

/** The built-in models. */
export function Samples({ page, samples }: { page: Page; samples: readonly Sample[] }) {
  if (samples.length === 0) return null;
  return (
    <>
      <h2>Samples</h2>
      <ul class="cards" aria-label="Samples">
        {samples.map(({ name, description }) => (
          <Card key={name} page={page} request={{ do: "open", sample: name }} name={name} detail={description} size={48} />
        ))}
      </ul>
    </>
  );
}

const noFiles: OwnFiles = { whole: [], files: [] };

/** Returns the files of these folders and of those within. */
function useFilesOf(page: Page, folders: readonly string[]): OwnFiles {
  const [found, setFound] = useState(noFiles);
  useEffect(() => {
    let wanted = true;
    const list = async (folder: string): Promise<OwnFiles> => {
      const answer = await page.editor.attempt({ do: "list", folder, deep: true });
      if ("code" in answer) return noFiles;
      const entries = (answer.files ?? []).filter((file) => typeof file !== "string");
      return {
        whole: answer.whole === true ? [folder] : [],
        files: entries.map(({ name, unsaved }) => ({ path: joined(folder, name), name, unsaved })),
      };
    };
    void Promise.all(folders.map(list)).then((lists) => {
      if (wanted) setFound({ whole: lists.flatMap(({ whole }) => whole), files: lists.flatMap(({ files }) => files) });
    });
    return () => {
      wanted = false;
    };
  }, [folders.join("\n"), page.editor.filesWritten.value]);
  return found;
}

interface CardProps {
  page: Page;
  request: OpenRequest;
  name: string;
  detail: string;
  tip?: string;
  /** Whether a session left unsaved changes or has the file open. */
  unsaved?: boolean;
  /** The side of the picture, in pixels. */
  size: number;
}

function Card({ page, request, name, detail, tip, unsaved = false, size }: CardProps) {
  return (
    <li>
      <button
        type="button"
        class="card"
        data-sample={request.sample}
        data-tip={tip}
        onClick={(event) => void openFromStart(page, request, event.detail === 0)}
      >
        <CardPicture page={page} request={request} size={size} />
        <span>
          <strong>{name}</strong>
          <small>{detail}</small>
          {wasLeftUnsaved(request) ? (
            <small class="unsaved">has unsaved work to restore</small>
          ) : (
            unsaved && <small class="unsaved">unsaved work</small>
          )}
        </span>
      </button>
    </li>
  );
}

/** The picture of a model, or an icon for an edit file. */
function CardPicture({ page, request: { path, sample }, size }: Pick<CardProps, "page" | "request" | "size">) {
  if (sample !== undefined) return <Thumbnail page={page} of={{ sample }} size={size} />;
  if (path !== undefined && !path.endsWith(".json")) return <Thumbnail page={page} of={{ path }} size={size} />;
  return (
    <span class="thumbnail" style={{ width: `${size}px`, height: `${size}px` }}>
      <Icon name="edit" size={size / 3} />
    </span>
  );
}
