import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { isFoundBy } from "../app/own_models";
import type { Page } from "../app/page";
import { counted } from "../app/units";
import { takeFile } from "./drop";
import { FolderBrowser, useListing } from "./folder_browser";
import { openFromStart, OwnModels, Samples, useOwnModels } from "./start_models";
import { Button } from "./ui/button";
import { Icon, Mark } from "./ui/icon";

/** Shown while nothing is open: own models, samples, folders, and an area to drop a file on. */
export function StartScreen({ page }: { page: Page }) {
  const { editor } = page;
  const [search, setSearch] = useState("");
  const isFound = isFoundBy(search);
  const own = useOwnModels(page, isFound);
  const samples = (editor.welcome.value?.samples ?? []).filter(({ name, description }) => isFound(`${name} ${description}`));
  const openFirst = () => {
    const [path] = own.paths;
    const [sample] = samples;
    if (search.trim() === "" || (path === undefined && sample === undefined)) return;
    void openFromStart(page, path === undefined ? { do: "open", sample: sample!.name } : { do: "open", path }, true);
  };
  const screen = useRef<HTMLDivElement>(null);
  const hasMore = useMoreBelow(screen);
  const opening = [...editor.working.value.values()].find(({ label }) => label === "Opening");
  return (
    <div class="start" ref={screen}>
      <div class="start-inner">
        <div class="start-title">
          <Mark size={44} />
          <div>
            <h1>meshgraft</h1>
            <p>Open a model, paint the area that you want to move, and drag the arrows.</p>
          </div>
          <input
            type="search"
            aria-label="Search models and samples"
            placeholder="Search models and samples"
            value={search}
            onInput={(event) => setSearch(event.currentTarget.value)}
            onKeyDown={(event) => event.key === "Enter" && openFirst()}
          />
        </div>
        <p class="start-found" role="status">
          {search.trim() !== "" && foundWords(own.paths.length + samples.length)}
        </p>
        <div class="start-columns">
          <div class="start-own">
            <OwnModels page={page} own={own} />
          </div>
          <div class="start-samples">
            <Samples page={page} samples={samples} />
          </div>
          <div class="start-files">
            <h2>From this computer</h2>
            <DropArea page={page} />
            <h2>Folders</h2>
            <Folders page={page} search={search} />
          </div>
        </div>
        <p class="start-foot">
          {opening === undefined ? `meshgraft ${editor.welcome.value?.version ?? ""}` : "Opening…"}
        </p>
      </div>
      {hasMore && (
        <div class="start-more" aria-hidden="true">
          <Icon name="down" size={16} />
        </div>
      )}
    </div>
  );
}

function foundWords(found: number): string {
  return found === 0 ? "Nothing has this name." : `${counted(found, "model")} found. Enter opens the first.`;
}

/** Returns whether an element can be scrolled farther down. */
function useMoreBelow(screen: RefObject<HTMLDivElement | null>): boolean {
  const [more, setMore] = useState(false);
  useEffect(() => {
    const { current } = screen;
    if (current === null) return undefined;
    const look = () => setMore(current.scrollTop + current.clientHeight < current.scrollHeight - 8);
    const observer = new ResizeObserver(look);
    for (const element of [current, ...current.children]) observer.observe(element);
    current.addEventListener("scroll", look);
    look();
    return () => {
      observer.disconnect();
      current.removeEventListener("scroll", look);
    };
  }, []);
  return more;
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

// The files of the folders themselves are own models, so the list begins with the folders.
function Folders({ page, search }: { page: Page; search: string }) {
  const [folder, setFolder] = useState<string | null>(null);
  const listing = useListing(page, folder);
  return (
    <FolderBrowser
      page={page}
      folder={folder}
      onFolder={setFolder}
      listing={listing}
      pictures
      searched={search}
      onFile={(path) => void page.editor.open({ do: "open", path })}
    />
  );
}
