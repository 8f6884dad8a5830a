import { signal } from "@preact/signals";

export type Shading = "clay" | "smooth" | "flat" | "texture" | "vertex-colours";
export type HeatMap = "none" | "stretch" | "seam" | "detail"; // detail: ‖δ‖; seam: of the current graft

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
  readonly unit = signal<"mm" | "cm" | "m" | "in" | "none">("mm"); // the unit of the model's coordinates
  readonly up = signal<"auto" | "y" | "z">("auto"); // the vertical axis; auto: by file format
  readonly orthographic = signal(false);
  readonly grid = signal(true); // on the ground
  readonly lessWhileMoving = signal(true); // fewer pixels while the view or a handle moves, if rendering is slow
}
