import type { MeshObject } from "../../app/graft/graft";
import { partToMirror } from "../../app/graft/mirror_latest";
import type { Page } from "../../app/page";
import { counted } from "../../app/units";
import { Thumbnail } from "./thumbnail";
import { IconButton } from "../ui/button";
import { Menu } from "../ui/menu";
import { Section } from "../ui/section";

/** The list of parts beside the model. */
export function PartsPanel({ page }: { page: Page }) {
  const { graft } = page.editor;
  const parts = graft.parts.value;
  if (parts.length === 0) return null;
  return (
    <Section
      title="Parts"
      hint="Meshes to graft onto the model: at their loops, or anywhere on its surface."
      badge={parts.length}
      startsOpen
    >
      <ul class="list parts-list" aria-label="Parts">
        {parts.map((part) => (
          <PartRow key={part.name} page={page} part={part} />
        ))}
      </ul>
    </Section>
  );
}

function PartRow({ page, part }: { page: Page; part: MeshObject }) {
  const { editor } = page;
  const { graft } = editor;
  const isSource = graft.step.value?.source === part.name;
  const idle = !graft.isEdited.value;
  const shown = graft.isShown(part);
  const known = () => Promise.resolve(part.name);
  const details = `${counted(part.loops, "loop")}${part.grafted ? ", grafted" : ""}`;
  return (
    <li class={isSource ? "active" : ""}>
      <button
        type="button"
        class="list-main part-row"
        disabled={!idle && !isSource}
        data-tip={idle ? "Click to graft at the loops, or drag onto the surface." : undefined}
        aria-label={`Graft ${part.name}`}
        onPointerDown={(event) => idle && page.graft.dragPart(known, event)}
        onClick={() => idle && void graft.startWith(part.name)}
      >
        <Thumbnail page={page} of={{ mesh: part.name }} version={part.mesh} size={34} />
        <span class="list-name">
          {part.name}
          <small>{details}</small>
        </span>
      </button>
      <IconButton
        label={shown ? `Hide ${part.name}` : `Show ${part.name}`}
        icon="through"
        pressed={shown}
        onClick={() => graft.toggleShown(part)}
      />
      <Menu
        label={`More for ${part.name}`}
        items={[
          {
            label: "Drop on the surface",
            icon: "region",
            disabled: !idle,
            run: () => void page.graft.dropByClick(known),
          },
          {
            label: "Mirrored copy",
            icon: "symmetry",
            disabled: partToMirror(editor) !== part.name,
            run: () => void editor.mirrorGraft(),
          },
          {
            label: "Make it the model",
            icon: "model",
            disabled: !idle,
            run: () => void editor.ask({ do: "part", what: "edit", name: part.name }),
          },
          {
            label: "Save as a part",
            icon: "save",
            disabled: !idle,
            run: () => void editor.folders.saveAsPart(part.name, part.name),
          },
          { label: "Export…", icon: "export", run: () => editor.askToExport(part.name) },
          {
            label: "Remove",
            icon: "remove",
            danger: true,
            begins: true,
            run: () => void editor.ask({ do: "part", what: "remove", name: part.name }),
          },
        ]}
      />
    </li>
  );
}
