import { axisNames, mostPlaneTiltDeg } from "../../app/graft/plane_tilt";
import { otherSide } from "../../app/cuts";
import { pointerKind } from "../../app/pointer_kind";
import type { Page } from "../../app/page";
import { Button } from "../ui/button";
import { Segments, Select, Slider } from "../ui/fields";
import { Section } from "../ui/section";
import { CutClosingFields } from "./cut_closing";

/** Cuts the model or a part open, by a plane or along a drawn curve. */
export function CutPanel({ page }: { page: Page }) {
  const { graft } = page.editor;
  const inWork = graft.isEdited.value;
  const tool = graft.tool.value;
  const chosen = tool === "plane" || tool === "stroke" ? tool : "none";
  return (
    <Section
      title="Cut"
      startsOpen
      hint="Cuts a mesh by a plane or along a closed curve: open, for grafting, or closed, for printing in pieces."
    >
      {inWork && <p class="hint">Accept or cancel the graft first.</p>}
      {!inWork && (
        <>
          <Segments
            label="Cut by"
            hideLabel
            value={chosen}
            choices={[
              { value: "none", label: "Off" },
              { value: "plane", label: "Plane", help: "Draw a line across the mesh, or choose an axis." },
              { value: "stroke", label: "Curve", help: "Draw around the piece to cut off." },
            ]}
            onChange={(value) => {
              graft.tool.value = value === "none" ? "loops" : value;
              if (value === "plane") page.graft.setPlane(graft.model.value?.mesh ?? -1, 2);
            }}
          />
          {chosen === "none" && graft.lastCut.value !== null && otherSide(graft.lastCut.value) !== undefined && (
            <Button
              label="Keep the other side instead"
              icon="reset"
              onClick={() => void graft.cutOtherwise()}
            />
          )}
        </>
      )}
    </Section>
  );
}

/** The cut in progress, shown above the other panels. */
export function CutInWork({ page }: { page: Page }) {
  const tool = page.editor.graft.tool.value;
  if (tool !== "plane" && tool !== "stroke") return null;
  return (
    <div class="cut-in-work" role="region" aria-label="Current cut">
      {tool === "plane" ? <PlaneFields page={page} /> : <CurveFields page={page} />}
    </div>
  );
}

function PlaneFields({ page }: { page: Page }) {
  const { graft } = page.editor;
  const { value: cut } = graft.cutPlane;
  const objects = graft.objects.value.filter(
    (object) => object.name === graft.model.value?.name || graft.isShown(object),
  );
  const name = graft.byMesh(cut?.mesh ?? -1)?.name ?? graft.model.value?.name ?? "";
  const plane = cut === null ? undefined : page.graft.planeOffset();
  const tilt = cut === null ? undefined : page.graft.planeTilt();
  return (
    <>
      <Select
        label="Cut"
        value={name}
        help="The mesh to cut."
        choices={objects.map((object) => ({ value: object.name, label: object.name }))}
        onChange={(value) => page.graft.setPlane(graft.byName(value)?.mesh ?? -1, 2)}
      />
      <div class="buttons" role="group" aria-label="Across an axis">
        {(["X", "Y", "Z"] as const).map((axis, k) => (
          <Button
            key={axis}
            label={`Across ${axis}`}
            onClick={() => page.graft.setPlane(cut?.mesh ?? graft.model.value?.mesh ?? -1, k as 0 | 1 | 2)}
          />
        ))}
      </div>
      {plane !== undefined && (
        <Slider
          label="Offset"
          min={-plane.limit}
          max={plane.limit}
          step={plane.limit / 50}
          digits={3}
          value={plane.offset}
          help="Distance of the plane from the middle, along its normal. A tilt changes it."
          onInput={(value) => page.graft.movePlane(value)}
          onChange={(value) => page.graft.movePlane(value)}
        />
      )}
      {tilt !== undefined &&
        ([0, 1] as const).map((k) => {
          const towards = axisNames[(tilt.axis + k + 1) % 3] as string;
          const turn = (to: number) => page.graft.tiltPlane({ ...tilt, degrees: k === 0 ? [to, tilt.degrees[1]] : [tilt.degrees[0], to] });
          return (
            <Slider
              key={towards}
              label={`Tilt to ${towards}`}
              min={-mostPlaneTiltDeg}
              max={mostPlaneTiltDeg}
              suffix="°"
              arrowStep={1}
              step={5}
              digits={3}
              value={Math.round(100 * tilt.degrees[k]) / 100}
              help={`Turns the plane, so that its normal leans from ${axisNames[tilt.axis]} towards ${towards}.`}
              onInput={turn}
              onChange={turn}
            />
          );
        })}
      {cut === null && <p class="hint">Draw a line across the model, or choose an axis.{pointerKind.value !== "touch" && " Middle-drag orbits."}</p>}
      {cut !== null && (
        <CutClosingFields
          closing={graft.cutClosing.value}
          unit={page.editor.view.unit.value}
          diagonal={page.editor.state.value?.model.diagonal ?? 1}
          onChange={(closing) => (graft.cutClosing.value = closing)}
        />
      )}
      {cut !== null && (
        <div class="buttons">
          <Button
            label="Keep blue side"
            kind="primary"
            tip="Keeps what lies on the blue side of the plane."
            onClick={() => void graft.cut("above")}
          />
          <Button label="Keep red side" onClick={() => void graft.cut("below")} />
          <Button label="Split, keep both" tip="Makes two objects. Each can be hidden, edited and exported." onClick={() => void graft.cut("both")} />
        </div>
      )}
    </>
  );
}

function CurveFields({ page }: { page: Page }) {
  const { graft } = page.editor;
  const { value: curve } = graft.cutCurve;
  if (curve === null || !curve.closed)
    return (
      <p class="hint">
        Draw a closed curve on the surface, around the piece to cut off.
      </p>
    );
  return (
    <div class="buttons">
      <Button
        label="Keep inside"
        kind="primary"
        tip="Keeps what the curve encloses, as you drew it."
        keys="Enter"
        onClick={() => void graft.cut("above")}
      />
      <Button label="Keep outside" onClick={() => void graft.cut("below")} />
      <Button label="Split, keep both" tip="Makes two objects. Each can be hidden, edited and exported." onClick={() => void graft.cut("both")} />
      <Button label="Draw again" kind="quiet" onClick={() => (graft.cutCurve.value = null)} />
    </div>
  );
}
