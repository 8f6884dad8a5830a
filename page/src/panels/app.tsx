import { render } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Page } from "../app/page";
import { Announcer } from "./announcer";
import { CubeMenu } from "./cube_menu";
import { DropZone } from "./drop";
import { ExportDialog, OpenDialog, SaveDialog } from "./file_dialogs";
import { GraftToolbar, GraftToolHint } from "./graft/graft_toolbar";
import { Header } from "./header";
import { HelpSheet } from "./help_sheet";
import { Messages } from "./messages";
import { HandedBack, LeaveQuestion, LostConnection, PageEffects, ReplaceQuestion, RestoreOffer } from "./overlays";
import { Side } from "./side";
import { StartScreen } from "./start_screen";
import { StatusBar } from "./status_bar";
import { ToolOptions } from "./tool_options";
import { Toolbar } from "./toolbar";
import { TourBubble } from "./tour_bubble";
import { Tooltips } from "./ui/tooltip";

/** The whole page: the view and the panels around it. */
export function App({ page }: { page: Page }) {
  const { editor } = page;
  const host = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (host.current !== null) page.attach(host.current);
    render(<CubeMenu page={page} />, page.viewport.cubeMenu);
  }, [page]);
  const isOpen = editor.isOpen.value;
  const panels = editor.view.panels.value;
  const grafts = editor.graft.mode.value === "graft";
  return (
    <div class={isOpen ? (panels ? "app" : "app folded") : "app empty-app"}>
      <Header page={page} />
      {isOpen && (grafts ? <GraftToolbar page={page} /> : <Toolbar page={page} />)}
      <main class="stage-area">
        <div class="view" ref={host} />
        {isOpen && (grafts ? <GraftToolHint page={page} /> : <ToolOptions page={page} />)}
        {!isOpen && editor.welcome.value !== null && <StartScreen page={page} />}
        <Messages page={page} />
        <TourBubble page={page} />
        <Tooltips />
      </main>
      {isOpen && panels && <Side page={page} />}
      <StatusBar page={page} />
      <Dialogs page={page} />
      <RestoreOffer page={page} />
      <LeaveQuestion page={page} />
      <ReplaceQuestion page={page} />
      <DropZone page={page} />
      <LostConnection page={page} />
      <HandedBack page={page} />
      <PageEffects page={page} />
      <Announcer page={page} />
    </div>
  );
}

function Dialogs({ page }: { page: Page }) {
  const { dialog } = page.editor;
  const close = () => (dialog.value = null);
  switch (dialog.value) {
    case "open":
      return <OpenDialog page={page} onClose={close} />;
    case "save":
      return <SaveDialog page={page} onClose={close} />;
    case "export":
      return <ExportDialog page={page} onClose={close} />;
    case "help":
      return <HelpSheet page={page} onClose={close} />;
    case null:
      return null;
  }
}
