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
    <Section title="View" hint="Display settings. They do not change the model.">
      <Select
        label="Shading"
        value={view.shading.value}
        choices={shadings}
        help="How the surface is drawn. Clay shows details best."
        onChange={(to) => (view.shading.value = to)}
      />
      <Select
        label="Heat map"
        value={view.heatMap.value}
        choices={heatMaps}
        help="Stretch: how much the surface has grown or shrunk. Detail: how far vertices stand out from their neighbours. Seam: how sharply the surface bends at the seam of the latest graft."
        onChange={(to) => (view.heatMap.value = to)}
      />
      {view.heatMap.value === "stretch" && (
        <Segments
          label="Stretch by"
          value={view.stretchOf.value}
          choices={[
            { value: "area", label: "Areas" },
            { value: "edges", label: "Edges" },
          ]}
          help="Compares areas or edge lengths with the mesh before this step."
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
        help="Darkens hollows (ambient occlusion). Faster when off."
        onChange={(on) => (view.ambientOcclusion.value = on)}
      />
      <Toggle
        label="Region and handles"
        value={view.showRoles.value}
        help="Colours the region, the handles and what is fixed."
        onChange={(on) => (view.showRoles.value = on)}
      />
      <Toggle
        label="Orthographic"
        value={view.orthographic.value}
        help={projection.help}
        keys={keysOf(projection.keys)}
        onChange={(on) => (view.orthographic.value = on)}
      />
      <Toggle
        label="Ground grid"
        value={view.grid.value}
        help="Shows a grid below the model."
        onChange={(on) => (view.grid.value = on)}
      />
      <Toggle
        label="Lower resolution while moving"
        value={view.lessWhileMoving.value}
        help="Draws fewer pixels while the view or a handle moves, if this machine is slow."
        onChange={(on) => (view.lessWhileMoving.value = on)}
      />
      <Segments
        label="Up axis"
        value={view.up.value}
        choices={[
          { value: "auto", label: "Auto", help: "From the file, or by its format." },
          { value: "y", label: "Y" },
          { value: "z", label: "Z" },
          ...(["auto", "y", "z"].includes(view.up.value) ? [] : [{ value: view.up.value, label: view.up.value.toUpperCase().replace("-", "−") }]),
        ]}
        help="The axis of this model that points up. It is remembered."
        onChange={(to) => view.chooseUp(to)}
      />
      <Select
        label="Unit"
        value={view.unit.value}
        choices={units}
        help="The unit of the model's coordinates. 3MF and glTF files state it; other files do not."
        onChange={(to) => view.chooseUnit(to)}
      />
    </Section>
  );
}
