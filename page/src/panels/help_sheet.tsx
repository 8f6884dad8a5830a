import { chordLabel } from "../app/chord";
import type { Command, CommandGroup } from "../app/keys";
import type { Page } from "../app/page";
import { CommandLabelButton } from "./command_button";
import { Dialog } from "./ui/dialog";

const groups: readonly [CommandGroup, string][] = [
  ["tool", "Tools"],
  ["handle", "Handles"],
  ["select", "Selection"],
  ["edit", "Edit"],
  ["view", "View"],
  ["file", "File"],
  ["help", "Help"],
];

const pointer: readonly [string, string][] = [
  ["Orbit", "drag beside the model, or middle-drag"],
  ["Pan", "right-drag, or Shift+middle-drag"],
  ["Zoom", "wheel, towards the pointer"],
  ["Frame a place", "double-click it"],
  ["Add to the selection", "Shift with a selection tool"],
  ["Subtract from it", "Alt with a selection tool"],
];

/** Keys that a gesture in progress takes, before they are commands. */
const whileMoving: readonly [string, string][] = [
  ["Keep to an axis", "X, Y or Z"],
  ["The other axes (own or world)", "the same key again"],
  ["Keep to a plane", "Shift and X, Y or Z"],
  ["How far", "a number: 1.5, −2, 90"],
  ["Change to move, rotate, scale", "G, R or S"],
  ["In steps", "Ctrl"],
  ["Confirm, cancel", "Enter or click, Esc"],
];
const whileDropping: readonly [string, string][] = [
  ["Rotate the part", "wheel, R or Shift+R"],
  ["Scale it", "Shift+wheel, S or Shift+S"],
  ["Cut a closed part higher, lower", "Alt+wheel, B or Shift+B"],
  ["Tilt that cut", "Alt+Shift+wheel, T or Shift+T"],
  ["Graft, cancel", "click, Space or Enter; Esc"],
];
const withoutPointer: readonly [string, string][] = [
  ["Move the cursor", "arrow keys, with Shift or Alt"],
  ["Click, begin or end a stroke", "Space"],
  ["Orbit", "Ctrl+arrow keys"],
  ["Zoom", "Page Up, Page Down"],
  ["Drop a part of the library", "Enter on its Drop button, arrow keys, Space"],
  ["Pair loops", "Pair loops by name, in the panel Graft"],
  ["Cut by a plane", "Offset and Tilt, in the panel Cut"],
];

const tour: readonly [string, string][] = [
  [
    "Open a model.",
    "Choose a file or a sample, or drop a file on the page. The file itself is never changed.",
  ],
  [
    "Paint a handle.",
    "Press H and paint the area to move: a nose, a hand, the end of a tail. When you release, the gizmo appears.",
  ],
  [
    "Drag the gizmo.",
    "Arrows move, rings rotate, boxes scale. The details follow. Rotate as far as you like: 720° is two full turns.",
  ],
  [
    "Set the reach.",
    "Reach, in the panel Handles, is how far the surface around the handle follows. The tint on the model shows it.",
  ],
  [
    "Fix what must not move.",
    "Select it with the brush or lasso and choose Make fixed; or make a second handle and leave it in place.",
  ],
  [
    "Graft a part.",
    "Choose Graft, and click a part in the library, or drag it onto the surface. Loops that meet are paired; the part takes its place from them.",
  ],
  ["Compare.", "Hold \\ to see the mesh before this step. Choose another method, under Method, to compare the results."],
  [
    "Continue, or save.",
    "Accept finishes the step; the next one starts from the new shape. Save writes all steps to an edit file; Export writes the mesh.",
  ],
];

/** All keys and a short tour. */
export function HelpSheet({ page, onClose }: { page: Page; onClose: () => void }) {
  return (
    <Dialog title="Help" onClose={onClose} wide>
      <div class="help" role="document" tabIndex={0}>
        <section aria-label="Tour">
          <h3>Two-minute tour</h3>
          <CommandLabelButton page={page} id="tour" icon="help" label="Start the guided tour" kind="primary" />
          <ol class="tour">
            {tour.map(([what, how]) => (
              <li key={what}>
                <strong>{what}</strong> {how}
              </li>
            ))}
          </ol>
          <p class="hint">
            Every change can be undone, and is saved to disk as you make it. Hover over anything to read what
            it does.
          </p>
        </section>
        <section aria-label="Keys">
          <div class="keys">
            <WordTable title="Pointer" rows={pointer} />
            <WordTable title="While moving, rotating, scaling" rows={whileMoving} />
            <WordTable title="While dropping a part" rows={whileDropping} />
            <WordTable title="In the view, without a pointer" rows={withoutPointer} />
            {groups.map(([group, title]) => (
              <KeyTable key={group} title={title} rows={rowsOf(page.commands, group)} />
            ))}
          </div>
        </section>
      </div>
    </Dialog>
  );
}

interface Row {
  keys: readonly string[];
  label: string;
  help: string;
}

function rowsOf(commands: readonly Command[], group: CommandGroup): Row[] {
  return commands
    .filter((command) => command.group === group && command.keys.length > 0)
    .map(({ keys, label, help }) => ({ keys: keys.map(chordLabel), label, help }));
}

function WordTable({ title, rows }: { title: string; rows: readonly [string, string][] }) {
  return (
    <table class="key-table">
      <caption>{title}</caption>
      <tbody>
        {rows.map(([label, how]) => (
          <tr key={label}>
            <th scope="row">{label}</th>
            <td>{how}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function KeyTable({ title, rows }: { title: string; rows: readonly Row[] }) {
  return (
    <table class="key-table">
      <caption>{title}</caption>
      <tbody>
        {rows.map(({ keys, label, help }) => (
          <tr key={label} title={help}>
            <th scope="row">{label}</th>
            <td>
              {keys.map((key) => (
                <kbd key={key}>{key}</kbd>
              ))}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
