import { commandOf, type Page } from "../app/page";
import type { Unit } from "../app/units";
import type { HeatMap, Shading } from "../app/view_settings";
import { keysOf } from "./command_button";
import { Segments, Select, Toggle, type Choice } from "./ui/fields";
import { Section } from "./ui/section";

const shadings: readonly Choice<Shading>[] = [
  { value: "clay", label: "Clay" },
  { value: "smooth", label: "Smooth" },
  { value: "flat", label: "Flat" },
  { value: "texture", label: "Texture" },
  { value: "vertex-colours", label: "Vertex colours" },
];
const heatMaps: readonly Choice<HeatMap>[] = [
  { value: "none", label: "None" },
  { value: "stretch", label: "Stretch" },
  { value: "detail", label: "Detail" },
  { value: "seam", label: "Seam" },
];
const units: readonly Choice<Unit>[] = [
  { value: "µm", label: "Micrometres" },
  { value: "mm", label: "Millimetres" },
  { value: "cm", label: "Centimetres" },
  { value: "m", label: "Metres" },
  { value: "in", label: "Inches" },
  { value: "ft", label: "Feet" },
  { value: "none", label: "None" },
];

/** The display settings. None of them changes the model. */
export function ViewPanel({ page }: { page: Page }) {
  const { view } = page.editor;
  const wireframe = commandOf(page, "wireframe");
  const projection = commandOf(page, "projection");
  return (
    <Section title="View" hint="How the model is shown. Nothing here changes it.">
      <Select
        label="Shading"
        value={view.shading.value}
        choices={shadings}
        help="Clay shows details best."
        onChange={(to) => (view.shading.value = to)}
      />
      <Select
        label="Heat map"
        value={view.heatMap.value}
        choices={heatMaps}
        help="Stretch: how much the surface has grown or shrunk. Detail: how far a vertex stands out of its neighbours. Seam: how a graft in work bends across the edges of its seam."
        onChange={(to) => (view.heatMap.value = to)}
      />
      {view.heatMap.value === "stretch" && (
        <Segments
          label="Stretch of"
          value={view.stretchOf.value}
          choices={[
            { value: "area", label: "Areas" },
            { value: "edges", label: "Edges" },
          ]}
          help="What is compared with the mesh before."
          onChange={(to) => (view.stretchOf.value = to)}
        />
      )}
      <Toggle
        label="Wireframe"
        value={view.wireframe.value}
        help={wireframe.help}
        keys={keysOf(wireframe.keys)}
        onChange={(on) => (view.wireframe.value = on)}
      />
      <Toggle
        label="Soft shadows"
        value={view.ambientOcclusion.value}
        help="Darkens hollows, so that shapes are read better. Off is quicker."
        onChange={(on) => (view.ambientOcclusion.value = on)}
      />
      <Toggle
        label="Region and handles"
        value={view.showRoles.value}
        help="Tints what may move, what is held and what stays."
        onChange={(on) => (view.showRoles.value = on)}
      />
      <Toggle
        label="Parallel projection"
        value={view.orthographic.value}
        help={projection.help}
        keys={keysOf(projection.keys)}
        onChange={(on) => (view.orthographic.value = on)}
      />
      <Toggle
        label="Ground grid"
        value={view.grid.value}
        help="A grid below the model."
        onChange={(on) => (view.grid.value = on)}
      />
      <Toggle
        label="Coarser while moving"
        value={view.lessWhileMoving.value}
        help="Fewer pixels while the view or a handle moves, where this machine is slow."
        onChange={(on) => (view.lessWhileMoving.value = on)}
      />
      <Segments
        label="Up"
        value={view.up.value}
        choices={[
          { value: "auto", label: "Auto", help: "As the file says, or by its kind." },
          { value: "y", label: "Y" },
          { value: "z", label: "Z" },
        ]}
        help="Which axis stands upright."
        onChange={(to) => (view.up.value = to)}
      />
      <Select
        label="Unit"
        value={view.unit.value}
        choices={units}
        help="What a unit of the model is. 3MF and glTF files name it, others do not."
        onChange={(to) => view.chooseUnit(to)}
      />
    </Section>
  );
}
