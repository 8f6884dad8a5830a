import type { Vector3 } from "three";
import { roundLength } from "./backdrop";
import type { Legend } from "./surface/heat";

type Unit = "mm" | "cm" | "m" | "in" | "none";

/** Formats a length in the model's unit with 3 significant digits. */
export function lengthText(length: number, unit: Unit): string {
  const digits = length === 0 ? "0" : Number(length.toPrecision(3)).toString();
  return unit === "none" ? digits : `${digits} ${unit}`;
}

/** Formats the size of a box, and adds millimetres if the unit is another length. */
export function sizeText(size: Vector3, unit: Unit): string {
  const sides = [size.x, size.y, size.z];
  const text = `${sides.map((side) => lengthText(side, "none")).join(" × ")}${unit === "none" ? "" : ` ${unit}`}`;
  const inMm = { mm: 0, none: 0, cm: 10, m: 1000, in: 25.4 }[unit];
  return inMm === 0 ? text : `${text} (${sides.map((side) => lengthText(side * inMm, "none")).join(" × ")} mm)`;
}

/** Shows the scale of the picture, the size of the model, and the legend of a heat map. */
export class ViewNotes {
  readonly notes = document.createElement("div");
  readonly legend = document.createElement("div");
  private readonly scaleText = document.createElement("div");
  private readonly scale = document.createElement("div");
  private readonly size = document.createElement("div");

  constructor() {
    this.notes.className = "view-notes";
    this.scale.className = "view-scale";
    this.size.className = "view-size";
    this.legend.className = "view-legend";
    this.legend.hidden = true;
    this.notes.append(this.scaleText, this.scale, this.size);
  }

  /** `worldPerPixel` is taken at the centre of the view. `size`: side lengths of the shown box. */
  update(worldPerPixel: number, size: Vector3 | undefined, unit: Unit): void {
    this.notes.hidden = size === undefined || !(worldPerPixel > 0);
    if (size === undefined) return;
    const length = roundLength(130 * worldPerPixel);
    setText(this.scaleText, lengthText(length, unit));
    this.scale.style.width = `${(length / worldPerPixel).toFixed(1)}px`;
    setText(this.size, unit === "mm" || unit === "none" ? "" : sizeText(size, unit)); // otherwise in the status bar
  }

  showLegend(legend: Legend | null): void {
    this.legend.hidden = legend === null;
    if (legend === null) return;
    const bar = document.createElement("div");
    bar.className = "view-legend-bar";
    bar.style.background = legend.gradient;
    const numbers = document.createElement("div");
    numbers.className = "view-legend-numbers";
    for (const value of [legend.min, (legend.min + legend.max) / 2, legend.max]) {
      const number = document.createElement("span");
      number.textContent = legend.format(value);
      numbers.append(number);
    }
    this.legend.replaceChildren(legend.title, bar, numbers);
  }
}

function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
