import { useRef } from "preact/hooks";
import type { PartSource } from "../../app/graft/graft";
import type { Pictured } from "../../app/library";
import { forFingers } from "../../app/pointer_kind";
import type { Page } from "../../app/page";
import { baseName, isWithin, joined } from "../../app/paths";
import { AddFolder } from "../add_folder";
import { takePartFile } from "../drop";
import { useListing } from "../folder_browser";
import { Thumbnail } from "./thumbnail";
import { Button, IconButton } from "../ui/button";
import { Icon } from "../ui/icon";
import { Section } from "../ui/section";

/** A mesh that can be added as a part. */
interface Offered {
  readonly name: string;
  readonly tip: string;
  readonly source: PartSource;
  readonly of: Pictured;
}

/** Parts to choose from: given at the start, in a folder, or built in. */
export function PartLibrary({ page }: { page: Page }) {
  const { editor } = page;
  const { value: welcome } = editor.welcome;
  const roots = welcome?.folders ?? [];
  const { ofParts } = editor.folders;
  const folder = ofParts.value;
  const isIn = (root: string) => folder !== null && isWithin(root, folder);
  const root = roots.filter(isIn).sort((a, b) => b.length - a.length)[0];
  const input = useRef<HTMLInputElement>(null);
  return (
    <Section
      title="Part library"
      hint={forFingers("Click a part to add it beside the model, or drag it onto the surface to graft it there.")}
      startsOpen
    >
      <GivenParts page={page} />
      <div class="library-bar">
        <select
          aria-label="Where parts come from"
          data-tip={folder ?? undefined}
          value={root ?? ""}
          onChange={(event) => (ofParts.value = event.currentTarget.value || null)}
        >
          <option value="">Samples</option>
          {roots.map((root) => (
            <option key={root} value={root}>
              {baseName(root) || root}
            </option>
          ))}
        </select>
        <Button
          label="Choose a file…"
          icon="upload"
          tip="Adds a file of this computer as a part."
          onClick={() => input.current?.click()}
        />
        <input
          ref={input}
          type="file"
          hidden
          aria-label="A part of this computer"
          accept=".ply,.obj,.off,.stl,.glb,.gltf,.3mf"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (file !== undefined) void takePartFile(page, file);
            event.currentTarget.value = "";
          }}
        />
      </div>
      {folder === null ? <SampleParts page={page} /> : <FolderParts page={page} root={root ?? folder} folder={folder} />}
      <AddFolder page={page} onAdded={(added) => (ofParts.value = added)} />
    </Section>
  );
}

/** Models of the command line, except the one that is open. */
function GivenParts({ page }: { page: Page }) {
  const { editor } = page;
  const open = editor.state.value?.model.name ?? "";
  const names = new Set([open, ...editor.graft.parts.value.map((part) => part.name)]);
  const others = (editor.welcome.value?.models ?? []).filter(
    (path) => !names.has(stem(path)) && !path.endsWith(".json"),
  );
  if (others.length === 0) return null;
  return <Cards page={page} label="Opened with the model" offered={others.map((path) => fromFile(path))} />;
}

function SampleParts({ page }: { page: Page }) {
  const samples = page.editor.welcome.value?.samples ?? [];
  const offered = samples.map(({ name, description }) => ({
    name,
    tip: description,
    source: { sample: name },
    of: { sample: name },
  }));
  return <Cards page={page} label="Samples" offered={offered} />;
}

function FolderParts({ page, root, folder }: { page: Page; root: string; folder: string }) {
  const setFolder = (to: string) => (page.editor.folders.ofParts.value = to);
  const listing = useListing(page, folder);
  const models = (listing?.files ?? []).filter((file) => file.kind === "model");
  return (
    <>
      <ul class="library-folders" aria-label="Folders">
        {folder !== root && (
          <li>
            <button type="button" onClick={() => setFolder(folder.slice(0, folder.lastIndexOf("/")) || root)}>
              <Icon name="up" size={14} /> up
            </button>
          </li>
        )}
        {(listing?.folders ?? []).map((name) => (
          <li key={name}>
            <button type="button" onClick={() => setFolder(joined(folder, name))}>
              <Icon name="folder" size={14} /> {baseName(name)}
            </button>
          </li>
        ))}
      </ul>
      <Cards
        page={page}
        label={baseName(folder)}
        offered={models.map((file) => fromFile(joined(folder, file.name)))}
      />
      {listing !== undefined && models.length === 0 && <p class="hint">No models in this folder.</p>}
    </>
  );
}

function fromFile(path: string): Offered {
  return { name: stem(path), tip: path, source: { path }, of: { path } };
}

function Cards({ page, label, offered }: { page: Page; label: string; offered: readonly Offered[] }) {
  return (
    <ul class="part-cards" aria-label={label}>
      {offered.map((one) => (
        <Card key={one.tip + one.name} page={page} offered={one} />
      ))}
    </ul>
  );
}

function Card({ page, offered }: { page: Page; offered: Offered }) {
  const { name, tip, source, of } = offered;
  const { graft } = page.editor;
  const add = () => graft.addPart(source, false);
  return (
    <li class="part-card">
      <button
        type="button"
        class="part-main"
        aria-label={`Add ${name}`}
        data-tip={`${tip}. Click to add it beside the model, or drag it onto the surface.`}
        onPointerDown={(event) => page.graft.dragPart(add, event)}
        onClick={() => void graft.addPart(source)}
      >
        <Thumbnail page={page} of={of} />
        <span>{name}</span>
      </button>
      <IconButton
        label={`Drop ${name} on the surface`}
        icon="region"
        tip="Then click the place on the surface. By keys: arrow keys move it, Space grafts it."
        onClick={(isByKey) => void page.graft.dropByClick(add, isByKey)}
      />
    </li>
  );
}

function stem(path: string): string {
  return baseName(path).replace(/\.[^.]*$/, "");
}
