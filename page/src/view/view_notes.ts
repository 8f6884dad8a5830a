import type { Unit } from "../app/units";
import { roundLength } from "./backdrop";
import type { Legend } from "./surface/heat";

/** Formats a length in the model's unit with 3 significant digits. */
export function lengthText(length: number, unit: Unit): string {
  const digits = length === 0 ? "0" : Number(length.toPrecision(3)).toString();
  return unit === "none" ? digits : `${digits} ${unit}`;
}

/** Shows the scale of the picture, and the legend of a heat map. */
export class ViewNotes {
  readonly notes = document.createElement("div");
  readonly legend = document.createElement("div");
  private readonly scaleText = document.createElement("div");
  private readonly scale = document.createElement("div");

  constructor() {
    this.notes.className = "view-notes";
    this.scale.className = "view-scale";
    this.legend.className = "view-legend";
    this.legend.hidden = true;
    this.notes.append(this.scaleText, this.scale);
  }

  /** `worldPerPixel` is taken at the centre of the view. */
  update(worldPerPixel: number, isShown: boolean, unit: Unit): void {
    this.notes.hidden = !isShown || !(worldPerPixel > 0);
    if (!isShown) return;
    const length = roundLength(130 * worldPerPixel);
    setText(this.scaleText, lengthText(length, unit));
    this.scale.style.width = `${(length / worldPerPixel).toFixed(1)}px`;
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
