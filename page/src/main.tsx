import { render } from "preact";
import { App } from "./panels/app";
import { Editor } from "./app/editor";
import { ViewSettings } from "./app/view_settings";
import { Viewport } from "./view/viewport";
import "./style.css";

const view = new ViewSettings();
const viewport = new Viewport(view);
const editor = new Editor(new URLSearchParams(location.search).get("token") ?? "", viewport, view);
const root = document.getElementById("app");
if (root !== null) render(<App editor={editor} viewport={viewport} />, root);
editor.start();

// For the tests, which look at what the page holds.
Object.assign(window, { meshgraft: { editor, viewport } });
