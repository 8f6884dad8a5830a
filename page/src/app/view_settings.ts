import { batch, computed, signal } from "@preact/signals";
import type { Unit } from "./units";
import type { Axis, Upright } from "./upright";

export type Shading = "clay" | "smooth" | "flat" | "texture" | "vertex-colours";
export type HeatMap = "none" | "stretch" | "seam" | "detail"; // detail: ‖δ‖; seam: of the current graft

export type Up = "auto" | Axis;

/** The settings of the display, changed by panels and read by the view. */
export class ViewSettings {
  readonly shading = signal<Shading>("clay");
  readonly heatMap = signal<HeatMap>("none");
  readonly stretchOf = signal<"area" | "edges">("area"); // the quantity that the heat map `stretch` compares with rest
  readonly wireframe = signal(false);
  readonly ambientOcclusion = signal(true);
  readonly showRoles = signal(true); // shows region, fixed part and handles in their colours
  readonly before = signal(false); // shows the mesh as the step found it
  readonly theme = signal<"system" | "light" | "dark">("system");
  /** The unit of models whose files name none, as the user chose it, by `folder`. */
  readonly unitsOfFolders = signal<Readonly<Record<string, Unit>>>({});
  /** The folder of the shown model's file. Without one: the name and size of a dropped file, or "samples". */
  readonly folder = signal("");
  private readonly fileUnit = signal<Unit>("none"); // that the model's file names
  private readonly otherUnit = signal<Unit | null>(null); // that the user chose in place of the file's
  /** The unit of the model's coordinates. */
  readonly unit = computed(() =>
    this.fileUnit.value === "none" ? (this.unitsOfFolders.value[this.folder.value] ?? "none") : (this.otherUnit.value ?? this.fileUnit.value),
  );
  /** Whether neither the file nor the user has told the unit of the models in this folder. */
  readonly isUnitUnknown = computed(
    () => this.fileUnit.value === "none" && this.unitsOfFolders.value[this.folder.value] === undefined,
  );
  /** The vertical axis of models, as the user chose it, by `model`. */
  readonly upsOfModels = signal<Readonly<Record<string, Axis>>>({});
  /** The front of models, as the user chose it, by `model`. */
  readonly frontsOfModels = signal<Readonly<Record<string, Axis>>>({});
  /** The path of the shown model. Without one: its sample, or the name and size of a dropped file. */
  readonly model = signal("");
  /** The vertical axis; auto: as in the model. */
  readonly up = computed((): Up => this.upsOfModels.value[this.model.value] ?? "auto");
  /** The front that the user chose for the shown model. */
  readonly front = computed((): Axis | undefined => this.frontsOfModels.value[this.model.value]);
  readonly orthographic = signal(false);
  readonly grid = signal(true); // on the ground
  readonly panels = signal(true); // at the right of the view
  readonly lessWhileMoving = signal(true); // fewer pixels while the view or a handle moves, if rendering is slow

  /** Takes the vertical axis that the user chose for the shown model. */
  chooseUp(up: Up): void {
    this.upsOfModels.value = withEntry(this.upsOfModels.value, this.model.value, up === "auto" ? undefined : up);
  }
  /** Takes how the shown model stands. */
  stand({ up, front }: Upright): void {
    batch(() => {
      this.chooseUp(up);
      this.frontsOfModels.value = withEntry(this.frontsOfModels.value, this.model.value, front);
    });
  }
  /** Forgets how the user put the shown model. */
  standAsInFile(): void {
    batch(() => {
      this.chooseUp("auto");
      this.frontsOfModels.value = withEntry(this.frontsOfModels.value, this.model.value, undefined);
    });
  }
  /** Takes the unit that the file of the shown model names. */
  setFileUnit(unit: Unit): void {
    if (unit !== this.fileUnit.value) this.otherUnit.value = null;
    this.fileUnit.value = unit;
  }
  /** Takes the unit that the user chose for the shown model, and for others of its `folder` whose files name none. */
  chooseUnit(unit: Unit): void {
    if (this.fileUnit.value === "none") this.unitsOfFolders.value = { ...this.unitsOfFolders.value, [this.folder.value]: unit };
    else this.otherUnit.value = unit;
  }
}

/** Returns a record with one entry set, or removed where it is undefined. */
function withEntry<Value>(record: Readonly<Record<string, Value>>, key: string, value: Value | undefined): Readonly<Record<string, Value>> {
  const { [key]: _, ...others } = record;
  return value === undefined ? others : { ...others, [key]: value };
}
