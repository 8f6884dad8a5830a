import type { Page } from "../app/page";
import type { Change } from "../protocol";
import { changeLabel } from "../app/request_labels";
import { CommandButton, CommandLabelButton, menuItem } from "./command_button";
import { IconButton } from "./ui/button";
import { Icon, Mark, type IconName } from "./ui/icon";
import { Menu } from "./ui/menu";

const themes = ["system", "light", "dark"] as const;
const themeIcons: Record<(typeof themes)[number], IconName> = {
  system: "system",
  light: "light",
  dark: "dark",
};

/** The bar at the top: files, name, undo and redo, before and after, accept, save, help, theme. */
export function Header({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const theme = editor.view.theme;
  const next = themes[(themes.indexOf(theme.value) + 1) % themes.length] ?? "system";
  return (
    <header class="header">
      <Menu
        label="File"
        class="file-button"
        items={[
          menuItem(page, "open", "open"),
          menuItem(page, "save", "save"),
          menuItem(page, "save-as"),
          menuItem(page, "export", "export"),
          menuItem(page, "save-part"),
          { ...menuItem(page, "help", "help"), begins: true },
          menuItem(page, "tour"),
        ]}
      >
        <Mark />
        <span>
          <span class="hidden">File menu of </span>meshgraft
        </span>
        <Icon name="down" size={14} />
      </Menu>
      {state !== null && (
        <>
          <span class="divider" />
          <DocumentName name={state.name} edit={state.edit} unsaved={editor.unsaved.value} />
          <span class="divider" />
          <CommandButton page={page} id="undo" icon="undo" tip={changeTip("Undo", state.undo)} />
          <CommandButton page={page} id="redo" icon="redo" tip={changeTip("Redo", state.redo)} />
          <CommandButton
            page={page}
            id="before"
            icon="before"
            label="Before and after"
            tip="Hold to see the mesh before this step."
          />
          <span class="space" />
          <CommandLabelButton page={page} id="accept" icon="accept" label="Accept" />
          <span class="divider" />
          {editor.isWaitedFor.value ? (
            <CommandLabelButton page={page} id="done" icon="accept" kind="primary" />
          ) : (
            <>
              <CommandButton page={page} id="save" icon="save" />
              <CommandButton page={page} id="export" icon="export" />
            </>
          )}
        </>
      )}
      {state === null && <span class="space" />}
      {state !== null && <CommandButton page={page} id="panels" icon="panels" />}
      <CommandButton page={page} id="help" icon="help" />
      <IconButton
        label={`Theme: ${theme.value}`}
        icon={themeIcons[theme.value]}
        tip={`Switch to ${next}.`}
        onClick={() => (theme.value = next)}
      />
    </header>
  );
}

function changeTip(verb: "Undo" | "Redo", change: Change | null): string {
  return change === null ? `Nothing to ${verb.toLowerCase()}.` : `${verb}: ${changeLabel(change)}`;
}

function DocumentName({ name, edit, unsaved }: { name: string; edit: string; unsaved: boolean }) {
  const file = edit === "" ? name : (edit.split("/").pop() ?? name);
  const tip = edit === "" ? "Not saved yet." : edit;
  return (
    <h1 class="document-name" data-tip={tip} data-label={unsaved ? "Unsaved changes" : "All saved"}>
      <span class="file-name">{file}</span>
      {unsaved && (
        <span class="unsaved" role="img" aria-label="unsaved changes">
          ●
        </span>
      )}
    </h1>
  );
}
