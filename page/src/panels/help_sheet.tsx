import { chordLabel } from "../app/chord";
import type { Command, CommandGroup } from "../app/keys";
import type { Page } from "../app/page";
import { Dialog } from "./ui/dialog";

const groups: readonly [CommandGroup, string][] = [
  ["tool", "Tools"],
  ["handle", "Handles"],
  ["select", "Selection"],
  ["edit", "Changes"],
  ["view", "View"],
  ["file", "Files"],
  ["help", "Help"],
];

const pointer: readonly [string, string][] = [
  ["Turn the view", "drag beside the model, or middle drag"],
  ["Shift it", "right drag, or Shift and middle drag"],
  ["Zoom", "wheel, towards the pointer"],
  ["Frame", "double click"],
  ["Select more, less", "Shift, Alt with a selection tool"],
];

const tour: readonly [string, string][] = [
  [
    "Open a model.",
    "A file of yours, a sample, or drop one on the page. Nothing happens to the file itself.",
  ],
  [
    "Paint a handle.",
    "Press H and paint over the part that you want to hold: a nose, a hand, the end of a tail. Where you let go, arrows appear.",
  ],
  [
    "Pull.",
    "Arrows move, rings turn, the boxes at the ends scale. Details follow. Turn as often as you like: 720° is twice round.",
  ],
  [
    "Say how far it reaches.",
    "Reach, at the right, is how much of the surface follows. The tint on the model shows it, and fades where the pull ends.",
  ],
  [
    "Hold what must stay.",
    "Select with brush or lasso and make it fixed; or make a second handle and leave it where it is.",
  ],
  ["Compare.", "Hold \\ to see the mesh before. Another method, under Method, shows its difference at once."],
  [
    "Go on, or keep it.",
    "Accept begins the next step on the new shape. Save keeps all steps in an edit file; Export writes the mesh.",
  ],
];

/** All keys and a short tour. */
export function HelpSheet({ page, onClose }: { page: Page; onClose: () => void }) {
  return (
    <Dialog title="Help" onClose={onClose} wide>
      <div class="help">
        <section aria-label="Tour">
          <h3>In two minutes</h3>
          <ol class="tour">
            {tour.map(([what, how]) => (
              <li key={what}>
                <strong>{what}</strong> {how}
              </li>
            ))}
          </ol>
          <p class="hint">
            Every change can be undone, and is on the disk as soon as it is made. Rest the pointer on anything
            to read what it is for.
          </p>
        </section>
        <section aria-label="Keys">
          <div class="keys">
            <PointerTable />
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

function PointerTable() {
  return (
    <table class="key-table">
      <caption>Pointer</caption>
      <tbody>
        {pointer.map(([label, how]) => (
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
