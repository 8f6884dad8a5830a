import { useRef, useState } from "preact/hooks";
import type { OpenRequest } from "../app/editor";
import type { Page } from "../app/page";
import { baseName, folderOf } from "../app/paths";
import { recentIn, wasLeftUnsaved } from "../app/recent";
import { takeFile } from "./drop";
import { FolderBrowser, useListing } from "./folder_browser";
import { Thumbnail } from "./graft/thumbnail";
import { Button } from "./ui/button";
import { Icon, Mark } from "./ui/icon";

/** Shown while nothing is open: models, samples, folders, and an area to drop a file on. */
export function StartScreen({ page }: { page: Page }) {
  const { editor } = page;
  const welcome = editor.welcome.value;
  const models = welcome?.models ?? [];
  const recent = recentIn(welcome?.folders ?? [], models);
  const opening = [...editor.working.value.values()].find(({ label }) => label === "Opening");
  return (
    <div class="start">
      <div class="start-inner">
        <div class="start-title">
          <Mark size={44} />
          <div>
            <h1>meshgraft</h1>
            <p>Open a model, paint the area that you want to move, and drag the arrows.</p>
          </div>
        </div>
        <div class="start-columns">
          <div class="start-own">
            {models.length > 0 && <Models page={page} title="Your models" models={models} />}
            {recent.length > 0 && <Models page={page} title="Recent" models={recent} />}
          </div>
          <div class="start-samples">
            <h2>Samples</h2>
            <ul class="cards">
              {(welcome?.samples ?? []).map(({ name, description }) => (
                <Card
                  key={name}
                  page={page}
                  request={{ do: "open", sample: name }}
                  name={name}
                  detail={description}
                />
              ))}
            </ul>
          </div>
          <div class="start-files">
            <h2>From this computer</h2>
            <DropArea page={page} />
            <h2>Folders</h2>
            <Folders page={page} />
          </div>
        </div>
        <p class="start-foot">{opening === undefined ? `meshgraft ${welcome?.version ?? ""}` : "Opening…"}</p>
      </div>
    </div>
  );
}

function Models({ page, title, models }: { page: Page; title: string; models: readonly string[] }) {
  return (
    <>
      <h2>{title}</h2>
      <ul class="cards models">
        {models.map((path) => (
          <Card key={path} page={page} request={{ do: "open", path }} name={baseName(path)} detail={folderOf(path)} />
        ))}
      </ul>
    </>
  );
}

/** The picture of a model, or an icon for an edit file. */
function CardPicture({ page, request }: { page: Page; request: OpenRequest }) {
  if ("sample" in request && request.sample !== undefined) return <Thumbnail page={page} of={{ sample: request.sample }} size={48} />;
  if ("path" in request && request.path !== undefined && !request.path.endsWith(".json"))
    return <Thumbnail page={page} of={{ path: request.path }} size={48} />;
  return <Icon name="edit" size={22} />;
}

function Card({
  page,
  request,
  name,
  detail,
}: {
  page: Page;
  request: OpenRequest;
  name: string;
  detail: string;
}) {
  return (
    <li>
      <button type="button" class="card" data-sample={request.sample} onClick={() => void page.editor.open(request)}>
        <CardPicture page={page} request={request} />
        <span>
          <strong>{name}</strong>
          <small>{detail}</small>
          {wasLeftUnsaved(request) && <small class="unsaved">has unsaved work to restore</small>}
        </span>
      </button>
    </li>
  );
}

function DropArea({ page }: { page: Page }) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <div class="drop-area">
      <Icon name="upload" size={26} />
      <p>Drop a file anywhere on this page</p>
      <Button label="Choose a file…" onClick={() => input.current?.click()} />
      <input
        ref={input}
        type="file"
        hidden
        aria-label="A model of this computer"
        accept=".ply,.obj,.off,.stl,.glb,.gltf,.3mf"
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          if (file !== undefined) void takeFile(page, file);
          event.currentTarget.value = "";
        }}
      />
      <small>PLY, OBJ, OFF, STL, glTF, 3MF; up to 1 GB</small>
    </div>
  );
}

function Folders({ page }: { page: Page }) {
  const roots = page.editor.welcome.value?.folders ?? [];
  const [folder, setFolder] = useState<string | null>(roots.length === 1 ? (roots[0] ?? null) : null);
  const listing = useListing(page, folder);
  return (
    <FolderBrowser
      page={page}
      folder={folder}
      onFolder={setFolder}
      listing={listing}
      pictures
      onFile={(path) => void page.editor.open({ do: "open", path })}
    />
  );
}
