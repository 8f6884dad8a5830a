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
import { asPercent, fromPercent, mirrorTolerance } from "../app/symmetry";
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
      hint="Mirrors every edit across a plane."
      badge={symmetry === null ? "off" : "on"}
    >
      <Toggle
        label="Symmetric editing"
        value={symmetry !== null}
        help="Each handle gets a mirrored copy on the other side."
        onChange={(on) => void editor.setSymmetry(on)}
      />
      {symmetry !== null && (
        <>
          <PlaneFields editor={editor} plane={symmetry.plane} />
          <p class="hint">
            {symmetry.twins.length === 0
              ? "No mirrored handles yet."
              : `Mirrored: ${symmetry.twins.map(({ of }) => of).join(", ")}.`}
          </p>
        </>
      )}
      <Slider
        label="Tolerance"
        value={asPercent(symmetry?.tolerance_rel ?? mirrorTolerance.value)}
        min={1e-7}
        max={100}
        softMin={1e-3}
        softMax={10}
        logarithmic
        step={0.1}
        suffix="%"
        help="How far a vertex may be from another one's mirror image, in per cent of the model's diagonal."
        onChange={(percent) => tolerate(fromPercent(percent))}
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
          ...(axis === undefined ? [{ value: "slanted" as const, label: "Tilted" }] : []),
        ]}
        onChange={(to) => to !== "slanted" && put(planeAcross(to, box))}
      />
      {axis === undefined ? (
        <p class="hint">The plane's normal is {plane.normal.map((n) => formatNumber(n, 3)).join(", ")}.</p>
      ) : (
        <Slider
          label="Offset"
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
          help="Position of the plane along this axis. By default the middle of the model."
          onChange={(coordinate) => put(planeAcross(axis, box, coordinate))}
        />
      )}
    </>
  );
}
