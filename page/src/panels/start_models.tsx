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

/** The models and edit files of the user as large cards, those that were opened last first. */
export function OwnModels({ page, isFound }: { page: Page; isFound: (name: string) => boolean }) {
  const welcome = page.editor.welcome.value;
  const folders = welcome?.folders ?? [];
  const files = useFilesOf(page, folders);
  const unsaved = new Set(files.files.filter((file) => file.unsaved).map(({ path }) => path));
  const [all, setAll] = useState(false);
  const list = useRef<HTMLUListElement>(null);
  useLayoutEffect(() => {
    if (all) list.current?.children[mostUnasked]?.querySelector("button")?.focus(); // the button that had it is gone
  }, [all]);
  const recent = recentIn(folders, []);
  const own = ownModels(recent, welcome?.models ?? [], files).filter((path) => isFound(baseName(path)));
  if (own.length === 0) return null;
  const shown = all ? own : own.slice(0, mostUnasked);
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
      {shown.length < own.length && <Button label={`Show all ${own.length}`} kind="quiet" onClick={() => setAll(true)} />}
    </>
  );
}

/** The built-in models. */
export function Samples({ page, isFound }: { page: Page; isFound: (name: string) => boolean }) {
  const samples = (page.editor.welcome.value?.samples ?? []).filter(({ name, description }) => isFound(`${name} ${description}`));
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

const noFiles: OwnFiles = { read: [], files: [] };

/** Returns the files of these folders, without those of folders within. */
function useFilesOf(page: Page, folders: readonly string[]): OwnFiles {
  const [found, setFound] = useState(noFiles);
  useEffect(() => {
    let wanted = true;
    const list = async (folder: string): Promise<OwnFiles> => {
      const answer = await page.editor.attempt({ do: "list", folder });
      if ("code" in answer) return noFiles;
      const entries = (answer.files ?? []).filter((file) => typeof file !== "string");
      return { read: [folder], files: entries.map(({ name, unsaved }) => ({ path: joined(folder, name), unsaved })) };
    };
    void Promise.all(folders.map(list)).then((lists) => {
      if (wanted) setFound({ read: lists.flatMap(({ read }) => read), files: lists.flatMap(({ files }) => files) });
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
        onClick={() => void page.editor.open(request)}
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
