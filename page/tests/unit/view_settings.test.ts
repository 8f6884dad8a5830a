import { describe, expect, it } from "vitest";
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

  it("is the usual one of the user for all models whose files name none", () => {
    const view = new ViewSettings();
    view.chooseUnit("cm");
    view.setFileUnit("m");
    expect(view.unit.value).toBe("m");
    view.setFileUnit("none");
    expect(view.unit.value).toBe("cm");
    view.chooseUnit("none");
    expect(view.unit.value).toBe("none");
  });
});
