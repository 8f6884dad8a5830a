import { describe, expect, it } from "vitest";
import { chordLabel, chordOf, matches, parseChord, type KeyPress } from "../../src/app/chord";
import { makeCommands, type CommandContext } from "../../src/app/commands";
import { commandFor } from "../../src/app/keys";

function press(key: string, fields: Partial<KeyPress> = {}): KeyPress {
  return { key, code: "", ctrlKey: false, metaKey: false, shiftKey: false, altKey: false, ...fields };
}

// The table is made without running anything, so nothing of the context is touched.
const nothing = { editor: {}, settings: {}, view: {}, tools: {}, viewport: {}, page: {} };
const commands = makeCommands(nothing as CommandContext);

describe("the table of commands", () => {
  it("gives no key to two commands", () => {
    const owners = new Map<string, string>();
    for (const command of commands)
      for (const keys of command.keys) {
        const chord = JSON.stringify(parseChord(keys));
        expect(owners.get(chord) ?? command.id, `${keys} of ${command.id}`).toBe(command.id);
        owners.set(chord, command.id);
      }
    expect(owners.size).toBeGreaterThan(40);
  });

  it("has one id, a label and a line of help for each", () => {
    expect(new Set(commands.map(({ id }) => id)).size).toBe(commands.length);
    for (const { id, label, help } of commands) {
      expect(label, id).toMatch(/^[A-Z]/);
      expect(help, id).toMatch(/^[A-Z].*\.$/);
    }
  });

  it("leaves X to the gestures, which come first for Y and Z, too", () => {
    expect(commandFor(commands, press("X"))).toBeUndefined();
  });

  it("finds commands by what a keyboard sends", () => {
    expect(commandFor(commands, press("z", { ctrlKey: true }))?.id).toBe("undo");
    expect(commandFor(commands, press("Z", { ctrlKey: true, shiftKey: true }))?.id).toBe("redo");
    expect(commandFor(commands, press("z", { metaKey: true }))?.id).toBe("undo");
    expect(commandFor(commands, press("?", { shiftKey: true, code: "Slash" }))?.id).toBe("help");
    expect(commandFor(commands, press("1", { code: "Numpad1" }))?.id).toBe("look-front");
    expect(commandFor(commands, press("1", { code: "Digit1" }))?.id).toBe("look-front");
    expect(commandFor(commands, press("8", { code: "Digit8" }))?.id).toBe("look-bottom"); // no number pad is needed
    expect(commandFor(commands, press("9", { code: "Digit9" }))).toBeUndefined();
  });
});

describe("chords", () => {
  it("take the plus key by itself", () => {
    expect(parseChord("ctrl++")).toEqual({ ctrl: true, shift: false, alt: false, key: "+" });
    expect(() => parseChord("strg+Z")).toThrow();
  });

  it("leave AltGr to the character that it types", () => {
    const bracket = press("[", { ctrlKey: true, altKey: true, getModifierState: (name) => name === "AltGraph" });
    expect(matches(parseChord("["), bracket)).toBe(true);
  });

  it("know letters whatever alt makes of them, and capitals without shift", () => {
    expect(chordOf(press("å", { altKey: true, code: "KeyA" }))).toEqual(parseChord("alt+A"));
    expect(chordOf(press("A"))).toEqual(parseChord("A"));
  });

  it("read well on buttons", () => {
    expect(chordLabel("ctrl+shift+Z")).toBe("Ctrl+Shift+Z");
    expect(chordLabel("Num1")).toBe("Num 1");
    expect(chordLabel("alt+A")).toBe("Alt+A");
  });
});
