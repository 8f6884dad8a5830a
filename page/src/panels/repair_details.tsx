import { noteWords } from "../app/wording";
import type { DetailsProps } from "./step_details";
import { NumberField, Select, Toggle } from "./ui/fields";

const switches: readonly { field: string; label: string; help: string }[] = [
  { field: "clean_faces", label: "Useless faces", help: "Removes faces without area, and all but one of equal faces." },
  { field: "remove_duplicate_shells", label: "Repeated pieces", help: "Removes pieces that lie on another one." },
  { field: "weld", label: "Open seams", help: "Joins edges that lie on each other." },
  { field: "split_non_manifold", label: "Non-manifold edges", help: "Takes apart edges of more than two faces." },
  { field: "remove_debris", label: "Crumbs", help: "Removes pieces that are tiny beside the largest one." },
  { field: "unify_winding", label: "Inside out", help: "Turns faces over, so that all face outward." },
  { field: "remove_isolated", label: "Loose vertices", help: "Removes vertices of no face." },
];

const holeChoices = [
  { value: "none", label: "None" },
  { value: "auto", label: "Small ones" },
  { value: "some", label: "Up to a size" },
  { value: "all", label: "All" },
] as const;
type Holes = (typeof holeChoices)[number]["value"];

const mostHoleEdges = 100_000; // of an edit file
const usualHoleEdges = 30; // where "Up to a size" is chosen

/** Returns the choice for the field `hole_edges` of a repair step. */
export function holesOf(edges: unknown): Holes {
  if (typeof edges !== "number") return "auto";
  return edges === 0 ? "none" : edges >= mostHoleEdges ? "all" : "some";
}

/** Returns the field `hole_edges` for a choice. */
export function holeEdgesOf(choice: Holes): number | "auto" {
  return { none: 0, auto: "auto" as const, some: usualHoleEdges, all: mostHoleEdges }[choice];
}

/** What a repair step changed, and the switches of its parts. */
export function RepairDetails({ page, step: { fields, found }, index }: DetailsProps) {
  const change = (changes: Record<string, boolean | number | string>) =>
    void page.editor.ask({ do: "step", what: "change", index, fields: changes });
  const values = fields as Record<string, unknown>;
  const edges = values["hole_edges"];
  const holes = holesOf(edges);
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
        onChange={(to) => change({ hole_edges: holeEdgesOf(to) })}
      />
      {holes === "some" && (
        <label class="row">
          <span id={`hole-edges-${index}`}>Largest hole</span>
          <NumberField
            label="Largest hole"
            labelledBy={`hole-edges-${index}`}
            value={Number(edges)}
            suffix="edges"
            min={3}
            max={mostHoleEdges}
            integer
            tip="Holes with more edges stay open."
            onChange={(most) => change({ hole_edges: most })}
          />
        </label>
      )}
    </div>
  );
}
