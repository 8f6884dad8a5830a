import type { Editor } from "../app/editor";
import {
  axisOfPlane,
  coordinateOf,
  planeAcross,
  rangeAlong,
  type Plane,
  type PlaneAxis,
} from "../app/mirror_plane";
import type { Page } from "../app/page";
import { mirrorTolerance } from "../app/symmetry";
import { formatNumber } from "../app/units";
import { Segments, Slider, Toggle } from "./ui/fields";
import { Section } from "./ui/section";

/** The settings of symmetry, which applies every edit on one side to the other side, too. */
export function SymmetryPanel({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const symmetry = state?.symmetry ?? null;
  const tolerate = (tolerance_rel: number) => {
    mirrorTolerance.value = tolerance_rel;
    if (symmetry !== null) void editor.ask({ do: "symmetry", plane: symmetry.plane, tolerance_rel });
  };
  return (
    <Section
      title="Symmetry"
      hint="What you do on one side of a plane happens on the other side, too."
      badge={symmetry === null ? "off" : "on"}
    >
      <Toggle
        label="Symmetric editing"
        value={symmetry !== null}
        help="Each handle gets a twin at its mirror image."
        onChange={(on) => void editor.setSymmetry(on)}
      />
      {symmetry !== null && (
        <>
          <PlaneFields editor={editor} plane={symmetry.plane} />
          <p class="hint">
            {symmetry.twins.length === 0
              ? "No handle has a twin yet."
              : `Twins: ${symmetry.twins.map(({ of }) => of).join(", ")}.`}
          </p>
        </>
      )}
      <Slider
        label="Tolerance"
        value={symmetry?.tolerance_rel ?? mirrorTolerance.value}
        min={1e-9}
        max={1}
        softMin={1e-5}
        softMax={0.1}
        logarithmic
        step={0.001}
        help="How far a vertex may be from the mirror image of another one, × the diagonal of the model."
        onChange={tolerate}
      />
    </Section>
  );
}

function PlaneFields({ editor, plane }: { editor: Editor; plane: Plane }) {
  const box = editor.box.value;
  const axis = axisOfPlane(plane);
  const unit = editor.view.unit.value;
  if (box === null) return null;
  const put = (next: Plane) => void editor.ask({ do: "symmetry", plane: next });
  const [low, high] = rangeAlong(axis ?? "x", box);
  return (
    <>
      <Segments<PlaneAxis | "slanted">
        label="Across"
        value={axis ?? "slanted"}
        choices={[
          { value: "x", label: "X", help: "Left and right, for most models." },
          { value: "y", label: "Y" },
          { value: "z", label: "Z" },
          ...(axis === undefined ? [{ value: "slanted" as const, label: "slanted" }] : []),
        ]}
        onChange={(to) => to !== "slanted" && put(planeAcross(to, box))}
      />
      {axis === undefined ? (
        <p class="hint">The plane's normal is {plane.normal.map((n) => formatNumber(n, 3)).join(", ")}.</p>
      ) : (
        <Slider
          label="Place"
          value={coordinateOf(plane, axis)}
          min={-Infinity}
          max={Infinity}
          softMin={low}
          softMax={high}
          quantity="length"
          unit={unit}
          suffix={unit === "none" ? "" : unit}
          step={0.01 * (high - low)}
          digits={3}
          help="Where the plane is along this axis; at first in the middle of the model."
          onChange={(coordinate) => put(planeAcross(axis, box, coordinate))}
        />
      )}
    </>
  );
}
