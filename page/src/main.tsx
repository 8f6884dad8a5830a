import { render } from "preact";
import { makeCommands, type PageActions } from "./app/commands";
import { Editor } from "./app/editor";
import { listenForKeys } from "./app/keys";
import { followPointerKind } from "./app/pointer_kind";
import { followOtherTabs, rememberSettings } from "./app/remembered";
import { followShownBox } from "./app/shown_box";
import { takeToken } from "./app/token";
import { Tour } from "./app/tour";
import { ViewSettings } from "./app/view_settings";
import { viewActions } from "./app/view_actions";
import { App } from "./panels/app";
import { ToolBox } from "./tools/toolbox";
import { GraftView } from "./view/graft/graft_view";
import { Viewport } from "./view/viewport";
import "./style.css";

const view = new ViewSettings();
rememberSettings({ theme: view.theme, unitsOfFolders: view.unitsOfFolders, upsOfModels: view.upsOfModels, frontsOfModels: view.frontsOfModels, grid: view.grid, panels: view.panels });
followOtherTabs("unitsOfFolders", view.unitsOfFolders);
followOtherTabs("upsOfModels", view.upsOfModels);
followOtherTabs("frontsOfModels", view.frontsOfModels);
const viewport = new Viewport(view);
const shownBox = followShownBox(viewport);
const editor = new Editor(takeToken(), viewport, view);
editor.folders.followOtherTabs();

const graftView = new GraftView(viewport, editor.graft);
const tools = new ToolBox(editor, viewport, graftView);

const tour = new Tour(editor);
const dialogs: PageActions = {
  open: () => (editor.dialog.value = "open"),
  save: () => void editor.save(),
  saveAs: () => (editor.dialog.value = "save"),
  exportMesh: () => editor.askToExport(),
  help: () => (editor.dialog.value = "help"),
  tour: () => tour.start(),
  skipTour: () => tour.skip(),
};
const commands = makeCommands({
  editor,
  settings: editor.tools,
  view,
  tools,
  viewport: viewActions(editor, viewport),
  page: dialogs,
});

function attach(host: HTMLElement): void {
  viewport.attach(host);
  tools.attach();
  graftView.start();
}

followPointerKind();
const root = document.getElementById("app");
if (root !== null) render(<App page={{ editor, viewport, shownBox, commands, graft: tools.graft, tour, attach }} />, root);
const isInDialog = () => document.querySelector("dialog[open]") !== null;
listenForKeys(
  () => (isInDialog() ? [] : commands),
  (event) => !isInDialog() && tools.takeKey(event),
);
editor.start();

// For the tests, which inspect the state of the page.
Object.assign(window, { meshgraft: { editor, graftView, viewport } });
