import { render } from "preact";
import { makeCommands, type PageActions } from "./app/commands";
import { Editor } from "./app/editor";
import { engineTools } from "./app/engine_tools";
import { listenForKeys } from "./app/keys";
import { rememberSettings } from "./app/remembered";
import { ViewSettings } from "./app/view_settings";
import { viewActions } from "./app/view_actions";
import { App } from "./panels/app";
import { Viewport } from "./view/viewport";
import "./style.css";

const view = new ViewSettings();
rememberSettings({ theme: view.theme, unit: view.unit, grid: view.grid });
const viewport = new Viewport(view);
const editor = new Editor(new URLSearchParams(location.search).get("token") ?? "", viewport, view);

const dialogs: PageActions = {
  open: () => (editor.dialog.value = "open"),
  save: () => void editor.save(),
  saveAs: () => (editor.dialog.value = "save"),
  exportMesh: () => (editor.dialog.value = "export"),
  help: () => (editor.dialog.value = "help"),
};
const commands = makeCommands({
  editor,
  settings: editor.tools,
  view,
  tools: { ...engineTools(editor), confirm: () => undefined, canConfirm: () => false, beginGesture: () => undefined },
  viewport: viewActions(editor, viewport),
  page: dialogs,
});

const root = document.getElementById("app");
if (root !== null) render(<App page={{ editor, viewport, commands }} />, root);
listenForKeys(() => (document.querySelector("dialog[open]") === null ? commands : []));
editor.start();

// For the tests, which look at what the page holds.
Object.assign(window, { meshgraft: { editor, viewport } });
