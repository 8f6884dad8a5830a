import { useState } from "preact/hooks";
import { groupColour } from "../app/colours";
import { groupsOf } from "../app/groups";
import type { Page } from "../app/page";
import { counted } from "../app/units";
import { Button } from "./ui/button";
import { Menu } from "./ui/menu";
import { Section } from "./ui/section";

/** The named selections of the document. */
export function GroupsPanel({ page }: { page: Page }) {
  const { editor } = page;
  const groups = groupsOf(editor.state.value);
  return (
    <Section
      title="Groups"
      hint="Named selections, to reuse."
      badge={groups.length === 0 ? undefined : groups.length}
    >
      {groups.length === 0 && editor.selected.value === 0 && (
        <p class="hint">Select vertices with Brush, Lasso or Box, then save them here.</p>
      )}
      <ul class="list" aria-label="Groups">
        {groups.map((group) => (
          <GroupRow key={group.name} page={page} name={group.name} colour={group.colour} />
        ))}
      </ul>
      <NewGroup
        page={page}
        taken={(editor.state.value?.groups ?? []).map(({ name }) => name)}
        colours={groups.map(({ colour }) => colour)}
      />
    </Section>
  );
}

function GroupRow({ page, name, colour }: { page: Page; name: string; colour: string }) {
  const { editor } = page;
  const disabled = editor.graft.isEdited.value;
  const select = (how: "set" | "add" | "remove" | "intersect") =>
    void editor.ask({ do: "select", how, what: name });
  return (
    <li>
      <input
        type="color"
        class="colour"
        aria-label={`Colour of ${name}`}
        value={colour === "" ? "#888888" : colour}
        onChange={(event) => void editor.recolour(name, event.currentTarget.value)}
      />
      <button
        type="button"
        class="list-main"
        data-tip="Click to select; Shift+click to add to the selection."
        onClick={(event) => select(event.shiftKey ? "add" : "set")}
      >
        <span class="list-name">{name}</span>
      </button>
      <Menu
        label={`More for ${name}`}
        items={[
          { label: "Select", run: () => select("set") },
          { label: "Add to the selection", run: () => select("add") },
          { label: "Subtract from the selection", run: () => select("remove") },
          { label: "Intersect with the selection", run: () => select("intersect") },
          {
            label: "Make region",
            icon: "region",
            begins: true,
            disabled,
            run: () => void editor.ask({ do: "region", select: name }),
          },
          { label: "Make fixed", icon: "fixed", disabled, run: () => void editor.ask({ do: "fixed", select: name }) },
          {
            label: "Make handle",
            icon: "handle",
            disabled,
            run: () => void editor.ask({ do: "handle", what: "add", select: name }),
          },
          {
            label: "Remove",
            icon: "remove",
            danger: true,
            begins: true,
            run: () => void editor.ask({ do: "group", name, remove: true }),
          },
        ]}
      />
    </li>
  );
}

function NewGroup({
  page,
  taken,
  colours,
}: {
  page: Page;
  taken: readonly string[];
  colours: readonly string[];
}) {
  const { editor } = page;
  const [name, setName] = useState("");
  const selected = editor.selected.value;
  const number = [...Array(taken.length + 1).keys()]
    .map((i) => i + 1)
    .find((i) => !taken.includes(`group ${i}`));
  const suggested = `group ${number ?? 1}`;
  const save = async () => {
    const chosen = name.trim() === "" ? suggested : name.trim();
    const done = await editor.ask({ do: "group", name: chosen, colour: groupColour(colours) });
    if (done === undefined) return;
    setName("");
    if (document.activeElement instanceof HTMLInputElement) document.activeElement.blur(); // keys run commands again
  };
  const replaces = taken.includes(name.trim());
  return (
    <form
      class="new-group"
      onSubmit={(event) => {
        event.preventDefault();
        if (selected > 0) void save();
      }}
    >
      <input
        type="text"
        aria-label="Name of the new group"
        placeholder={suggested}
        value={name}
        disabled={selected === 0}
        onInput={(event) => setName(event.currentTarget.value)}
        onKeyDown={(event) => event.key === "Escape" && event.currentTarget.blur()}
      />
      <Button
        label={replaces ? "Replace" : "Save selection"}
        icon="plus"
        disabled={selected === 0}
        tip={
          selected === 0
            ? "Select something first."
            : `Saves the ${counted(selected, "selected vertex", "selected vertices")} under this name.`
        }
        onClick={() => void save()}
      />
    </form>
  );
}
