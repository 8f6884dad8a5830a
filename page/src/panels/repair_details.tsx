import { noteWords } from "../app/wording";
import type { DetailsProps } from "./step_details";
import { Select, Toggle } from "./ui/fields";

const switches: readonly { field: string; label: string; help: string }[] = [
  { field: "clean_faces", label: "Useless faces", help: "Removes faces without area, and all but one of equal faces." },
  { field: "remove_duplicate_shells", label: "Repeated pieces", help: "Removes pieces that lie on another one." },
  { field: "weld", label: "Open seams", help: "Joins edges that lie on each other." },
  { field: "split_non_manifold", label: "Crowded edges", help: "Takes apart edges of more than two faces." },
  { field: "remove_debris", label: "Crumbs", help: "Removes pieces that are tiny beside the largest one." },
  { field: "unify_winding", label: "Inside out", help: "Turns faces over, so that all face outward." },
  { field: "remove_isolated", label: "Loose vertices", help: "Removes vertices of no face." },
];

const holeChoices = [
  { value: "none", label: "None" },
  { value: "auto", label: "Small ones" },
  { value: "all", label: "All" },
] as const;
type Holes = (typeof holeChoices)[number]["value"];

const mostHoleEdges = 100_000; // of an edit file

/** What a repair step changed, and the switches of its parts. */
export function RepairDetails({ page, step: { fields, found }, index }: DetailsProps) {
  const change = (changes: Record<string, boolean | number | string>) =>
    void page.editor.ask({ do: "step", what: "change", index, fields: changes });
  const values = fields as Record<string, unknown>;
  const edges = values["hole_edges"];
  const holes: Holes = edges === 0 ? "none" : edges === undefined || edges === "auto" ? "auto" : "all";
  const changes = found?.changes ?? [];
  return (
    <div class="step-details">
      {changes.length === 0 && <p class="hint">Nothing had to be mended.</p>}
      {changes.map(noteWords).map((words) => (
        <p class="hint" key={words}>
          {words}
        </p>
      ))}
      {switches.map(({ field, label, help }) => (
        <Toggle
          key={field}
          label={label}
          help={help}
          value={values[field] !== false}
          onChange={(on) => change({ [field]: on })}
        />
      ))}
      <Select
        label="Fill holes"
        value={holes}
        choices={holeChoices}
        help="All: also openings that are meant."
        onChange={(to) => change({ hole_edges: to === "none" ? 0 : to === "auto" ? "auto" : mostHoleEdges })}
      />
    </div>
  );
}
