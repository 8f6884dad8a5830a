import { useState } from "preact/hooks";
import { handleColour } from "../app/colours";
import { isAtRest } from "../app/handle_pose";
import type { Page } from "../app/page";
import { counted } from "../app/units";
import type { Handle } from "../protocol";
import { CommandLabelButton } from "./command_button";
import { PoseFields } from "./pose_fields";
import { NameField, Slider } from "./ui/fields";
import { Icon, type IconName } from "./ui/icon";
import { Menu } from "./ui/menu";
import { Section } from "./ui/section";

const shapeIcons: Record<Handle["shape"], IconName> = { region: "handle", curve: "curve", vertex: "vertex" };

/** The list of handles. A handle can be chosen, named, given a reach and posed. */
export function HandlesPanel({ page }: { page: Page }) {
  const { editor } = page;
  const handles = editor.state.value?.handles ?? [];
  const active = editor.tools.activeHandle.value;
  const index = handles.findIndex(({ name }) => name === active);
  const handle = handles[index];
  return (
    <Section
      title="Handles"
      hint="Areas that you move. The surface around them follows within their reach."
      badge={handles.length === 0 ? undefined : handles.length}
      startsOpen
    >
      {handles.length === 0 && (
        <div class="empty">
          <p>Paint the area that you want to move.</p>
          <CommandLabelButton page={page} id="tool-handle" icon="handle" kind="primary" />
        </div>
      )}
      <ul class="list" aria-label="Handles">
        {handles.map((one, i) => (
          <HandleRow key={one.name} page={page} handle={one} colour={handleColour(i)} active={i === index} />
        ))}
      </ul>
      {handle !== undefined && (
        <div class="active-handle" key={handle.name}>
          <ReachSlider page={page} handle={handle} />
          <PoseFields page={page} handle={handle} />
        </div>
      )}
      {handles.length > 0 && handle === undefined && <p class="hint">Click a handle to enter exact values.</p>}
    </Section>
  );
}

interface RowProps {
  page: Page;
  handle: Handle;
  colour: string;
  active: boolean;
}

function HandleRow({ page, handle, colour, active }: RowProps) {
  const { editor } = page;
  const [renames, setRenames] = useState(false);
  const pick = () => (editor.tools.activeHandle.value = active ? null : handle.name);
  const rename = (to: string) => {
    const wasActive = editor.tools.activeHandle.value === handle.name;
    void editor.ask({ do: "handle", what: "rename", name: handle.name, to }).then((done) => {
      if (done !== undefined && wasActive) editor.tools.activeHandle.value = to;
    });
  };
  return (
    <li class={active ? "active" : ""}>
      {renames ? (
        <NameField name={handle.name} onRename={rename} onEnd={() => setRenames(false)} />
      ) : (
        <button
          type="button"
          class="list-main"
          aria-pressed={active}
          data-tip={
            handle.vertices === undefined
              ? ""
              : `${counted(handle.vertices, "vertex", "vertices")}. Double-click to rename.`
          }
          onClick={pick}
          onDblClick={() => setRenames(true)}
          onKeyDown={(event) => event.key === "F2" && setRenames(true)}
        >
          <span class="swatch" style={{ color: colour }}>
            <Icon name={shapeIcons[handle.shape]} size={16} />
          </span>
          <span class="list-name">{handle.name}</span>
          {!isAtRest(handle.pose) && <span class="moved">moved</span>}
        </button>
      )}
      <Menu
        label={`More for ${handle.name}`}
        items={[
          { label: "Rename", icon: "rename", keys: "F2", run: () => setRenames(true) },
          {
            label: "Reset",
            icon: "reset",
            disabled: isAtRest(handle.pose),
            run: () => void editor.pose({ [handle.name]: {} }),
          },
          {
            label: "Remove",
            icon: "remove",
            danger: true,
            begins: true,
            run: () => void editor.ask({ do: "handle", what: "remove", name: handle.name }),
          },
        ]}
      />
    </li>
  );
}

function ReachSlider({ page, handle }: { page: Page; handle: Handle }) {
  const { editor } = page;
  const { reach } = handle;
  const diagonal = editor.state.value?.model.diagonal ?? 1;
  const unit = editor.view.unit.value;
  if (reach === undefined)
    return <p class="hint">This handle moves the whole region that you set, so it has no reach of its own.</p>;
  return (
    <>
    <Slider
      label="Reach"
      value={reach}
      min={1e-6 * diagonal}
      max={1e6 * diagonal}
      softMin={0.005 * diagonal}
      softMax={1.2 * diagonal}
      logarithmic
      quantity="length"
      unit={unit}
      suffix={unit === "none" ? "" : unit}
      step={0.01 * diagonal}
      digits={3}
      help="How far the surface around the handle follows, measured along the surface. The effect fades to zero there."
      onInput={(length) => (editor.tools.reachFor.value = { handle: handle.name, reach: length })}
      onChange={(length) =>
        void editor
          .ask({ do: "reach", handle: handle.name, reach: length })
          .then(() => (editor.tools.reachFor.value = null))
      }
    />
    <p class="hint">
      There is no falloff to set: from the handle to its reach, the surface takes on the change as evenly as it can. How
      it bends is chosen under Method.
    </p>
    </>
  );
}
