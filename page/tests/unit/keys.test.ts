import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { isPressedBy, listenForKeys, type Command } from "../../src/app/keys";

/** An element with what the listeners look at. */
class FakeElement {
  readonly dataset = {};
  readonly isContentEditable = false;
  constructor(
    readonly localName: string,
    readonly type?: string,
  ) {}
  blur(): void {}
}
class FakeInput extends FakeElement {}

const body = new FakeElement("body");
let focused: FakeElement;
let stop: () => void;
let did: string[];

function send(name: string, target: FakeElement, fields: object = {}): Event {
  const event = Object.assign(new Event(name, { cancelable: true }), { ctrlKey: false, metaKey: false, altKey: false, shiftKey: false, code: "", ...fields });
  Object.defineProperty(event, "target", { value: target });
  window.dispatchEvent(event);
  return event;
}

/** Presses a key as a browser does: the element with the focus is clicked unless that is prevented. */
function press(key: string): void {
  const [down, up] = [send("keydown", focused, { key, code: key }), send("keyup", focused, { key, code: key })];
  const clicks = isPressedBy(focused, key) && !(down.defaultPrevented || (key === " " && up.defaultPrevented));
  if (!clicks) return;
  send("click", focused);
  did.push(`click ${focused.localName}`);
}

function focus(element: FakeElement): void {
  focused = element;
  vi.stubGlobal("document", { body, activeElement: element });
  send("focusin", element);
}

function click(element: FakeElement): void {
  send("pointerdown", element);
  if (focused !== element) focus(element);
  send("click", element);
}

function tabTo(element: FakeElement): void {
  press("Tab");
  focus(element);
}

const confirm: Command = {
  id: "confirm", label: "Confirm", help: "", group: "edit", keys: ["Enter"],
  run: () => void did.push("confirm"), enabled: () => true,
};

describe("Enter and Space", () => {
  beforeEach(() => {
    vi.stubGlobal("window", new EventTarget());
    vi.stubGlobal("HTMLElement", FakeElement);
    vi.stubGlobal("HTMLInputElement", FakeInput);
    for (const name of ["HTMLTextAreaElement", "HTMLSelectElement"]) vi.stubGlobal(name, class {});
    did = [];
    stop = listenForKeys(() => [confirm]);
    focus(body);
  });
  afterEach(() => {
    stop();
    vi.unstubAllGlobals();
  });

  it("press a button that Tab moves the focus to", () => {
    tabTo(new FakeElement("button"));
    for (const key of ["Enter", " ", "Enter"]) press(key);
    expect(did).toEqual(["click button", "click button", "click button"]);
  });

  it("do not press a button that was clicked, until Tab comes back to it", () => {
    const undo = new FakeElement("button");
    click(undo);
    press("Enter");
    press(" ");
    expect(did).toEqual(["confirm"]);
    tabTo(new FakeElement("button"));
    tabTo(undo);
    press("Enter");
    expect(did).toEqual(["confirm", "click button"]);
  });

  it("do not press a button that was clicked when it had the focus already", () => {
    const undo = new FakeElement("button");
    tabTo(undo);
    click(undo);
    press("Enter");
    expect(did).toEqual(["confirm"]);
  });

  it("do not press a clicked button when a dialog gives the focus back", () => {
    const [save, field] = [new FakeElement("button"), new FakeInput("input", "text")];
    click(save);
    click(field);
    press("x");
    focus(save);
    press("Enter");
    expect(did).toEqual(["confirm"]);
  });

  it("confirm where Enter does nothing by itself", () => {
    click(new FakeInput("input", "checkbox"));
    press("Enter");
    tabTo(new FakeInput("input", "range"));
    press("Enter");
    expect(did).toEqual(["confirm", "confirm"]);
  });
});
