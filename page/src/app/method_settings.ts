/** The settings of a step's solve: docs/edit-file.md, "Settings". */
export type SettingValue = number | string | boolean;
export type Settings = Readonly<Record<string, SettingValue | undefined>>;
export type MethodName = "corotational" | "rotation-aware" | "ft05" | "shell";

interface Choice<Value extends string> {
  value: Value;
  label: string;
}

interface Common {
  key: string;
  label: string;
  /** One line for the user. */
  help: string;
  group: "shape" | "surface" | "flat" | "solver";
  /** Whether the setting is rarely needed. */
  more?: boolean;
  /** Returns whether the setting has an effect with these settings; absent: always. */
  applies?: (settings: Settings) => boolean;
}
export interface NumberSetting extends Common {
  kind: "number";
  defaultValue: number;
  /** The value of the preset, where it is another. */
  published?: number;
  min: number;
  max: number;
  softMin?: number;
  softMax?: number;
  logarithmic?: boolean;
  integer?: boolean;
}
export interface ChoiceSetting extends Common {
  kind: "choice";
  defaultValue: string;
  published?: string;
  choices: readonly Choice<string>[];
}
export interface SwitchSetting extends Common {
  kind: "switch";
  defaultValue: boolean;
}
export type Setting = NumberSetting | ChoiceSetting | SwitchSetting;

export const methods: readonly (Choice<MethodName> & { help: string })[] = [
  {
    value: "corotational",
    label: "Natural",
    help: "Details rotate with the surface, and limbs keep their thickness. Best for bending and dragging.",
  },
  {
    value: "shell",
    label: "Even bends",
    help: "Spreads bends evenly, as a thin shell does: the smoothest result. Takes longer; shown when you release.",
  },
  {
    value: "rotation-aware",
    label: "Smooth rotation",
    help: "Spreads rotation and scale of the handles evenly, for the smoothest twists and bends. Moves shear.",
  },
  {
    value: "ft05",
    label: "Linear",
    help: "The paper's method (Fu & Tai 2005). The fastest to drag; suits stretching, and rotations below about 40°.",
  },
];

/** The preset: settings with a name, which take the place of the defaults. */
export const preset = {
  value: "as-published",
  label: "As published",
  help: "The method as published in 2005; its results never change. Replaces the settings, which you can then change.",
};

export function hasPreset(settings: Settings): boolean {
  return settings["preset"] === preset.value;
}

const hasRotations = (settings: Settings) => methodOf(settings) !== "ft05";
const isCorotational = (settings: Settings) => ["corotational", "shell"].includes(methodOf(settings));
const flatPlaces = (settings: Settings) => settings["degenerate"] ?? (hasPreset(settings) ? "ft05-noise" : "auto");
const usesNoise = (settings: Settings) => flatPlaces(settings) !== "apex";
const usesApex = (settings: Settings) => flatPlaces(settings) !== "ft05-noise";

export const settingsTable: readonly Setting[] = [
  {
    key: "stiffness", kind: "number", label: "Stiffness", group: "shape", defaultValue: 60, published: 0, min: 0, max: 1e6,
    softMax: 1e4, logarithmic: true, applies: hasRotations,
    help: "How strongly edges keep their lengths. 0 bends most evenly.",
  },
  {
    key: "smoothing_length_rel", kind: "number", label: "Smoothing", group: "shape", defaultValue: 0.04, published: 0.09, min: 0, max: 10,
    softMax: 1, applies: isCorotational,
    help: "Spreads a bend that would crease. A length, relative to the width of the surface between the handles.",
  },
  {
    key: "laplacian_weight", kind: "number", label: "Detail weight", group: "shape", defaultValue: 20, published: 1, min: 0, max: 1e6,
    softMin: 0, softMax: 1000, logarithmic: true,
    help: "How strongly details keep their shape, compared with a smooth bend. The paper uses 1.",
  },
  {
    key: "iterations", kind: "number", label: "Iterations", group: "shape", more: true, defaultValue: 20, min: 0, max: 1000,
    softMax: 100, integer: true, applies: isCorotational,
    help: "Maximum number of iterations. It stops earlier when the surface has settled.",
  },
  {
    key: "laplacian_order", kind: "number", label: "Laplacian order", group: "shape", more: true, defaultValue: 1, min: 1,
    max: 3, integer: true, help: "1 follows the details most closely; 2 and 3 bend more like a plate.",
  },
  {
    key: "weights", kind: "choice", label: "Weights", group: "surface", defaultValue: "uniform",
    choices: [{ value: "uniform", label: "Uniform" }, { value: "cotangent", label: "Cotangent" }],
    help: "Uniform suits all triangles; cotangent takes their shapes into account.",
  },
  {
    key: "density", kind: "choice", label: "Density", group: "surface", defaultValue: "aware", published: "ft05",
    choices: [{ value: "aware", label: "By area" }, { value: "ft05", label: "By vertex (paper)" }],
    help: "By area, the result does not depend on how finely the surface is triangulated.",
  },
  {
    key: "weld", kind: "switch", label: "Weld seams", group: "surface", defaultValue: true,
    help: "Boundary vertices at the same position move together. Switch off to let touching pieces separate.",
  },
  {
    key: "refine_boundary", kind: "choice", label: "Refine at handles", group: "surface", more: true, defaultValue: "auto", published: "0",
    choices: [
      { value: "auto", label: "Automatic" },
      { value: "0", label: "Off" },
      { value: "1", label: "Once" },
      { value: "2", label: "Twice" },
      { value: "3", label: "3 times" },
      { value: "4", label: "4 times" },
    ],
    help: "Subdivides the surface around handles for the solve, for a smoother result. Automatic: around single vertices and "
      + "other handles without an inside. Otherwise drags are solved only when you release.",
  },
  {
    key: "degenerate", kind: "choice", label: "Flat areas", group: "flat", defaultValue: "auto", published: "ft05-noise",
    choices: [
      { value: "auto", label: "Automatic" },
      { value: "apex", label: "Virtual apex" },
      { value: "ft05-noise", label: "Noise (paper)" },
    ],
    help: "How areas without details of their own, which are flat, are solved.",
  },
  {
    key: "apex_height_rel", kind: "number", label: "Apex height", group: "flat", more: true, defaultValue: 0.5, min: 0.001,
    max: 10, softMin: 0.05, softMax: 2, applies: usesApex, help: "Relative to the mean edge length at the vertex.",
  },
  {
    key: "noise_length_rel", kind: "number", label: "Noise length", group: "flat", more: true, defaultValue: 0.25, min: 0.001,
    max: 10, softMin: 0.01, softMax: 1, applies: usesNoise, help: "Relative to the mean edge length at the vertex.",
  },
  {
    key: "noise_lengths", kind: "choice", label: "Noise lengths", group: "flat", more: true, defaultValue: "equal", published: "random",
    choices: [{ value: "equal", label: "Equal, either side" }, { value: "random", label: "Random, one side (paper)" }],
    applies: usesNoise, help: "Random lengths are 0.8 to 1.2 times the noise length.",
  },
  {
    key: "flatness", kind: "number", label: "Flatness", group: "flat", more: true, defaultValue: 5e-5, min: 0, max: 1,
    softMin: 1e-7, softMax: 1e-2, logarithmic: true,
    help: "A vertex counts as flat below this ratio of eigenvalues.",
  },
  {
    key: "seed", kind: "number", label: "Seed", group: "flat", more: true, defaultValue: 1, min: 0, max: 1e9, softMax: 100,
    integer: true, applies: usesNoise, help: "Changes the random noise.",
  },
  {
    key: "residual_corrections", kind: "number", label: "Corrections", group: "solver", more: true, defaultValue: 1, min: 0,
    max: 10, integer: true, help: "Passes that remove rounding errors. 1 is nearly always enough.",
  },
  {
    key: "backend", kind: "choice", label: "Solver", group: "solver", more: true, defaultValue: "auto",
    choices: [
      { value: "auto", label: "Automatic" },
      { value: "multifrontal", label: "Multifrontal" },
      { value: "eigen", label: "Eigen" },
      { value: "iterative", label: "Iterative (little memory)" },
    ],
    help: "Solver for the equations. Automatic chooses one that fits in memory.",
  },
  {
    key: "proxy", kind: "number", label: "Proxy vertices", group: "solver", more: true, defaultValue: 0, min: 0, max: 1e7,
    softMax: 50000, integer: true,
    help: "0 solves the full mesh. Otherwise a simplified mesh with about this many vertices (at least 50) is solved.",
  },
];

export const groupNames: Readonly<Record<Setting["group"], string>> = {
  shape: "Shape",
  surface: "Surface",
  flat: "Flat areas",
  solver: "Solver",
};

/** Returns the value of a setting that is not given. */
export function usualOf(settings: Settings, setting: NumberSetting): number;
export function usualOf(settings: Settings, setting: ChoiceSetting): string;
export function usualOf(settings: Settings, { defaultValue, published }: NumberSetting | ChoiceSetting): number | string {
  return (hasPreset(settings) ? published : undefined) ?? defaultValue;
}

export function numberOf(settings: Settings, setting: NumberSetting): number {
  const value = settings[setting.key];
  return typeof value === "number" ? value : usualOf(settings, setting);
}
export function choiceOf(settings: Settings, setting: ChoiceSetting): string {
  const value = settings[setting.key];
  return typeof value === "string" || typeof value === "number" ? String(value) : usualOf(settings, setting);
}
/** Returns the setting that a choice stands for: a number for digits, otherwise the choice itself. */
export function settingOf(choice: string): SettingValue {
  return /^\d+$/.test(choice) ? Number(choice) : choice;
}
export function switchOf(settings: Settings, { key, defaultValue }: SwitchSetting): boolean {
  const value = settings[key];
  return typeof value === "boolean" ? value : defaultValue;
}
export function methodOf(settings: Settings): MethodName {
  return methods.find(({ value }) => value === settings["method"])?.value ?? (hasPreset(settings) ? "ft05" : "corotational");
}

/** Returns the settings that have an effect with the chosen method. */
export function applicable(settings: Settings): Setting[] {
  return settingsTable.filter((setting) => setting.applies?.(settings) !== false);
}

/** The changes of settings that a request makes; null removes a setting. */
export type SettingChanges = Record<string, SettingValue | null>;

/** Returns the changes that reset all settings to their defaults, and take the preset off. The method stays. */
export function changesToDefaults(settings: Settings): SettingChanges {
  const changes: SettingChanges = {};
  if (settings["preset"] !== undefined) Object.assign(changes, { preset: null, method: methodOf(settings) });
  for (const { key, defaultValue } of settingsTable)
    if (settings[key] !== undefined && settings[key] !== defaultValue) changes[key] = defaultValue;
  return changes;
}

/** Raises the size of a requested proxy to the minimum of 50 vertices. */
export function admissible(setting: NumberSetting, value: number): number {
  return setting.key === "proxy" && value > 0 ? Math.max(50, value) : value;
}
