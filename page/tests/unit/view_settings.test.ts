import { describe, expect, it, test } from "vitest";
import { asksForUnit } from "../../src/app/unit_question";
import { ViewSettings } from "../../src/app/view_settings";

describe("the unit of lengths", () => {
  it("is what the file names, and none where it names none", () => {
    const view = new ViewSettings();
    expect(view.unit.value).toBe("none");
    view.setFileUnit("m");
    expect(view.unit.value).toBe("m");
    view.setFileUnit("none");
    expect(view.unit.value).toBe("none");
  });

  it("is what the user chooses for a model, until the file of another one names a unit", () => {
    const view = new ViewSettings();
    view.setFileUnit("m");
    view.chooseUnit("mm");
    expect(view.unit.value).toBe("mm");
    view.setFileUnit("m"); // a change of the same model
    expect(view.unit.value).toBe("mm");
    view.setFileUnit("in");
    expect(view.unit.value).toBe("in");
    view.setFileUnit("m");
    expect(view.unit.value).toBe("m");
  });

  it("is chosen once for all models of a folder whose files name none", () => {
    const view = new ViewSettings();
    view.folder.value = "/scans";
    expect(view.isUnitUnknown.value).toBe(true);
    view.chooseUnit("cm");
    expect(view.isUnitUnknown.value).toBe(false);
    view.setFileUnit("m");
    expect([view.unit.value, view.isUnitUnknown.value]).toEqual(["m", false]);
    view.setFileUnit("none");
    expect(view.unit.value).toBe("cm");
    view.folder.value = "/prints";
    expect([view.unit.value, view.isUnitUnknown.value]).toEqual(["none", true]);
    view.chooseUnit("none");
    expect([view.unit.value, view.isUnitUnknown.value]).toEqual(["none", false]);
    view.folder.value = "/scans";
    expect(view.unit.value).toBe("cm");
  });

  it("is asked for where an STL or OBJ file comes from a folder", () => {
    const view = new ViewSettings();
    const asks = (folder: string, file: string) => {
      view.folder.value = folder;
      return asksForUnit(view, { file });
    };
    expect(asks("/scans", "/scans/arm.STL")).toBe(true);
    expect(asks("/scans", "arm.obj")).toBe(true);
    expect(asks("/scans", "/scans/arm.ply")).toBe(false);
    expect(asks("samples", "")).toBe(false);
    view.chooseUnit("mm");
    expect(asks("/scans", "/scans/arm.stl")).toBe(true);
    view.chooseUnit("mm");
    expect(asks("/scans", "/scans/leg.stl")).toBe(false);
  });
});

test("the up axis is remembered for each model", () => {
  const view = new ViewSettings();
  view.model.value = "/scans/arm.stl";
  expect(view.up.value).toBe("auto");
  view.chooseUp("y");
  view.model.value = "/scans/leg.stl";
  expect(view.up.value).toBe("auto");
  view.model.value = "/scans/arm.stl";
  expect(view.up.value).toBe("y");
  view.chooseUp("auto");
  expect(view.upsOfModels.value).toEqual({});
});
