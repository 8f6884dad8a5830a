import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Editor } from "../../src/app/editor";
import { ViewSettings } from "../../src/app/view_settings";
import type { DocumentState } from "../../src/protocol";
import type { Viewport } from "../../src/view/viewport";

/** A socket to an engine that the test plays. */
class FakeSocket {
  static readonly OPEN = 1;
  static last: FakeSocket;
  readyState = 0;
  readonly asked: { id: number; do: string }[] = [];
  onopen?: () => void;
  onclose?: () => void;
  onmessage?: (event: { data: string }) => void;
  constructor() {
    FakeSocket.last = this;
  }
  send(text: string): void {
    this.asked.push(JSON.parse(text));
  }
  open(): void {
    this.readyState = FakeSocket.OPEN;
    this.onopen?.();
    this.tell({ event: "welcome", version: "", folders: [], models: [], samples: [], waited_for: false });
  }
  tell(message: object): void {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
  /** Answers the last request of this kind. */
  async answer(kind: string, fields: object = { result: {} }): Promise<void> {
    const { id } = this.asked.filter((request) => request.do === kind).at(-1) ?? {};
    if (id === undefined) throw new Error(`no ${kind} was asked`);
    this.tell({ re: id, ...fields });
    await settle();
  }
}

const settle = () => new Promise((resolve) => setTimeout(resolve));

function documentState(fields: Partial<DocumentState>): DocumentState {
  return {
    event: "state", name: "bar", up: "y", front: "-y", unit: "", edit: "", model: { name: "a", mesh: 1, loops: 0, vertices: 8, faces: 12, diagonal: 1, findings: [] }, steps: [], handles: [], groups: [],
    counts: null, settings: {}, symmetry: null, notes: [], file: "a.ply", parts: [], graft: null, selected: 0, selected_on: "a", undo: null, redo: null, set_up_for: null, dirty: false,
    ...fields,
  };
}

const clean = documentState({});
const changed = documentState({ dirty: true, undo: "pose" });
const offer = { event: "offer-restore", changes: 1, undone: 0, last: "pose" };
const failed = { error: { id: "new.fact", code: "io", fields: {}, problem: "no", location: "", remedy: "", notes: [] } };

describe("the mark of unsaved changes", () => {
  let editor: Editor;
  let stored: Map<string, string>;

  /** Loses the connection, and lets it come back. */
  async function reconnect(): Promise<FakeSocket> {
    FakeSocket.last.readyState = 3;
    FakeSocket.last.onclose?.();
    await vi.waitFor(() => expect(FakeSocket.last.readyState).toBe(0), { timeout: 5000 });
    FakeSocket.last.open();
    await settle();
    return FakeSocket.last;
  }

  beforeEach(async () => {
    stored = new Map();
    const storage = { getItem: (key: string) => stored.get(key) ?? null, setItem: (key: string, text: string) => void stored.set(key, text) };
    vi.stubGlobal("location", { href: "http://here/?token=", pathname: "/" });
    vi.stubGlobal("WebSocket", FakeSocket);
    vi.stubGlobal("sessionStorage", storage);
    vi.stubGlobal("fetch", () => Promise.resolve({ status: 200 }));
    const viewport = { setDocument: () => undefined, modelVisible: Promise.resolve() };
    editor = new Editor("", viewport as unknown as Viewport, new ViewSettings());
    editor.start();
    FakeSocket.last.open();
    const opened = editor.open({ do: "open", path: "/bar.ply" });
    FakeSocket.last.tell(clean);
    await FakeSocket.last.answer("open");
    expect(await opened).toBe(true);
  });
  afterEach(() => vi.unstubAllGlobals());

  it("comes with a change and goes when it is undone or saved", () => {
    const { last } = FakeSocket;
    const marks = [clean, changed, clean, changed, { ...clean, edit: "/e.json", undo: "pose" }, { ...changed, edit: "/e.json" }].map((state) => {
      last.tell(state);
      return editor.unsaved.value;
    });
    expect(marks).toEqual([false, true, false, true, false, true]);
  });

  it("remembers the document for a reload as soon as it is open", () => {
    expect(JSON.parse(stored.get("meshgraft open /") ?? "")).toEqual({ do: "open", path: "/bar.ply" });
  });

  it("stays while a lost connection comes back, and goes with the last change that is undone", async () => {
    FakeSocket.last.tell(changed);
    const back = await reconnect();
    expect(editor.unsaved.value).toBe(true);
    back.tell(clean);
    back.tell(offer);
    await back.answer("open");
    expect(editor.unsaved.value).toBe(true);
    back.tell(changed);
    await back.answer("restore");
    expect(editor.unsaved.value).toBe(true);
    back.tell({ ...clean, redo: "pose" });
    expect(editor.unsaved.value).toBe(false);
    back.tell(changed);
    expect(editor.unsaved.value).toBe(true);
  });

  it("stays where what was undone before had been saved", async () => {
    FakeSocket.last.tell({ ...clean, edit: "/e.json", undo: "pose" });
    FakeSocket.last.tell({ ...changed, edit: "/e.json" });
    const back = await reconnect();
    back.tell(clean);
    back.tell(offer);
    await back.answer("open");
    back.tell(changed);
    await back.answer("restore");
    back.tell({ ...clean, dirty: true });
    expect(editor.unsaved.value).toBe(true);
  });

  it("does not appear where nothing was to be restored", async () => {
    const back = await reconnect();
    back.tell(clean);
    await back.answer("open");
    expect(editor.unsaved.value).toBe(false);
  });

  it("stays where the connection is lost again, and the document is opened once more", async () => {
    FakeSocket.last.tell(changed);
    await reconnect();
    const back = await reconnect();
    expect(editor.unsaved.value).toBe(true);
    expect(back.asked.map((request) => request.do)).toContain("open");
    back.tell(clean);
    back.tell(offer);
    await back.answer("open");
    back.tell(changed);
    await back.answer("restore");
    back.tell(clean);
    expect(editor.unsaved.value).toBe(false);
  });

  it("changes that could not be restored are offered again", async () => {
    FakeSocket.last.tell(changed);
    const back = await reconnect();
    back.tell(clean);
    back.tell(offer);
    await back.answer("open");
    await back.answer("restore", failed);
    expect(editor.offer.value).toEqual(offer);
  });
});
