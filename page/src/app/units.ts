import type { DocumentState } from "../protocol";

export type Unit = "µm" | "mm" | "cm" | "m" | "in" | "ft" | "none";
export type Quantity = "length" | "angle" | "factor" | "number";

const lengthsMm: Record<string, number> = {
  µm: 0.001,
  um: 0.001,
  mm: 1,
  cm: 10,
  dm: 100,
  m: 1000,
  in: 25.4,
  '"': 25.4,
  ft: 304.8,
  "'": 304.8,
};
/** The unit of a model by the name that its file gives it. */
export const unitsOfFiles: Record<DocumentState["unit"], Unit> = {
  "": "none",
  micron: "µm",
  millimeter: "mm",
  centimeter: "cm",
  inch: "in",
  foot: "ft",
  meter: "m",
};
const anglesDeg: Record<string, number> = {
  "°": 1,
  deg: 1,
  rad: 180 / Math.PI,
  turn: 360,
  turns: 360,
};

/** Formats `value` with at most `digits` significant digits and `decimals` decimals, without trailing zeros. */
export function formatNumber(value: number, digits = 4, decimals = 12): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size < 0.5 * 10 ** -decimals) return "0";
  if (size >= 1e7 || size < 1e-5) return value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
  const decimalPlaces = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  const text = value.toFixed(Math.min(decimals, decimalPlaces));
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

/** Returns an angle as typed if it is the same rotation as `angleDeg`: 180 and not -180. */
export function asTyped(angleDeg: number, typed: number): number {
  const turns = (angleDeg - typed) / 360;
  return Math.abs(turns - Math.round(turns)) < 0.1 / 360 + 1e-9 ? typed : angleDeg;
}

/** Formats the side lengths of a box in model units, with the unit's name. */
export function formatSize(sides: readonly number[], unit: Unit): string {
  const text = sides.map((side) => formatNumber(side, 3)).join(" × ");
  return unit === "none" ? text : `${text} ${unit}`;
}

/** Formats the side lengths of a box in millimetres; empty if the unit is this one, or unknown. */
export function formatSizeInMm(sides: readonly number[], unit: Unit): string {
  const factor = unit === "mm" ? undefined : lengthsMm[unit];
  return factor === undefined ? "" : formatSize(sides.map((side) => side * factor), "mm");
}

export function formatCount(count: number): string {
  return String(Math.round(count)).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

/** Formats a count: "1 vertex", "2 vertices". */
export function counted(count: number, one: string, many = `${one}s`): string {
  return `${formatCount(count)} ${count === 1 ? one : many}`;
}

export function formatSeconds(seconds: number): string {
  if (seconds < 0.001) return "< 1 ms";
  if (seconds < 0.9995) return `${formatNumber(1000 * seconds, seconds < 0.01 ? 2 : 3)} ms`;
  if (seconds < 60) return `${formatNumber(seconds, 2)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

export function formatBytes(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  const steps = ["kB", "MB", "GB", "TB"];
  let size = bytes / 1000;
  let step = 0;
  for (; size >= 999.5 && step + 1 < steps.length; ++step) size /= 1000;
  return `${formatNumber(size, 3)} ${steps[step]}`;
}

/** Formats a relative error as a percentage of the movement. */
export function formatPercent(part: number): string {
  if (part === 0) return "0 %";
  return part < 0.001 ? "< 0.1 %" : `${formatNumber(100 * part, 2)} %`;
}

/**
 * Parses typed text: a number or a small calculation (+ − × ÷ and brackets). Each number may have a unit ("1 in + 2
 * mm", "2 turns", "150 %", "1,5"). Returns model units, degrees or a factor; undefined if the text is invalid.
 */
export function parseQuantity(text: string, quantity: Quantity, unit: Unit = "none"): number | undefined {
  const parser = new Parser(text, (name) => factorOf(name, quantity, unit));
  const value = parser.parse();
  return value !== undefined && Number.isFinite(value) ? value : undefined;
}

function factorOf(name: string, quantity: Quantity, unit: Unit): number | undefined {
  if (quantity === "length" && unit !== "none") {
    const mm = lengthsMm[name];
    return mm === undefined ? undefined : mm / (lengthsMm[unit] as number);
  }
  if (quantity === "angle") return anglesDeg[name];
  if (quantity === "factor") return name === "%" ? 0.01 : name === "×" || name === "x" ? 1 : undefined;
  return undefined;
}

/** sum = product {+ product}, product = signed {* signed}, signed = [-] (number [unit] | "(" sum ")"). */
class Parser {
  private rest: string;

  constructor(
    text: string,
    private readonly factorOf: (unit: string) => number | undefined,
  ) {
    this.rest = text.trim().replace(/[−–]/g, "-").replace(/·/g, "*").replace(/÷/g, "/");
    this.rest = this.rest.replace(/(?<=\d)[ \u00a0\u202f](?=\d{3}(?!\d))/g, ""); // thousands separators
  }

  parse(): number | undefined {
    const value = this.sum();
    return this.rest === "" ? value : undefined;
  }

  private take(pattern: RegExp): string | undefined {
    const found = pattern.exec(this.rest)?.[0];
    if (found !== undefined) this.rest = this.rest.slice(found.length).trimStart();
    return found;
  }

  private sum(): number | undefined {
    let value = this.product();
    for (let sign = this.take(/^[+-]/); sign !== undefined && value !== undefined; sign = this.take(/^[+-]/)) {
      const next = this.product();
      value = next === undefined ? undefined : value + (sign === "+" ? next : -next);
    }
    return value;
  }

  private product(): number | undefined {
    let value = this.signed();
    for (let sign = this.take(/^[*/]/); sign !== undefined && value !== undefined; sign = this.take(/^[*/]/)) {
      const next = this.signed();
      value = next === undefined ? undefined : sign === "*" ? value * next : value / next;
    }
    return value;
  }

  private signed(): number | undefined {
    if (this.take(/^-/) !== undefined) {
      const value = this.signed();
      return value === undefined ? undefined : -value;
    }
    this.take(/^\+/);
    return this.take(/^\(/) !== undefined ? this.bracket() : this.number();
  }

  private bracket(): number | undefined {
    const value = this.sum();
    return this.take(/^\)/) === undefined ? undefined : value;
  }

  private number(): number | undefined {
    const digits = this.take(/^(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?/i);
    if (digits === undefined) return undefined;
    const value = Number(digits.replace(",", "."));
    const unit = this.take(/^([a-zµ]+|[°%×"'])/i);
    if (unit === undefined) return value;
    const factor = this.factorOf(unit.toLowerCase());
    return factor === undefined ? undefined : value * factor;
  }
}
