import { signal } from "@preact/signals";

export type Shading = "clay" | "smooth" | "flat" | "texture" | "vertex-colours";
export type HeatMap = "none" | "stretch" | "seam" | "detail"; // detail: ‖δ‖; seam: of a graft in work

/** How things are shown: panels change it, the view reads it. */
export class ViewSettings {
  readonly shading = signal<Shading>("clay");
  readonly heatMap = signal<HeatMap>("none");
  readonly stretchOf = signal<"area" | "edges">("area"); // what the heat map `stretch` compares with rest
  readonly wireframe = signal(false);
  readonly ambientOcclusion = signal(true);
  readonly showRoles = signal(true); // region, fixed part and handles in their colours
  readonly before = signal(false); // the mesh as the step found it
  readonly theme = signal<"system" | "light" | "dark">("system");
  readonly unit = signal<"mm" | "cm" | "m" | "in" | "none">("mm"); // what a unit of the model is called
  readonly up = signal<"auto" | "y" | "z">("auto"); // which axis stands upright; auto: by the kind of file
  readonly orthographic = signal(false);
  readonly grid = signal(true); // on the ground
  readonly lessWhileMoving = signal(true); // fewer pixels while the view or a handle moves, where that is slow
}
