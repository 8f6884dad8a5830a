import { signal } from "@preact/signals";
import type { Pose } from "../protocol";

/**
 * The active tool, which decides what a drag on the surface does. A drag off the surface turns the view, except with
 * lasso and box.
 */
export type ToolName =
  | "navigate"
  | "handle" // paints a handle; a region within its reach appears around it
  | "brush"
  | "lasso"
  | "box"
  | "connected"
  | "loop"
  | "flood"
  | "vertex" // a handle of one vertex
  | "curve" // a handle along shortest paths between clicked points
  | "measure" // the distance of two clicked points, to scale by
  | "flat"; // lays the model flat on a clicked face

/** The tools that change the model. */
export const changingTools: ReadonlySet<ToolName> = new Set(["handle", "vertex", "curve", "flat"]);

/** The settings of the tools, changed by panels and read by tools. Lengths in pixels are CSS pixels. */
export class ToolSettings {
  readonly tool = signal<ToolName>("navigate");
  readonly brushRadiusPx = signal(24);
  readonly through = signal(false); // also selects hidden vertices
  readonly combine = signal<"set" | "add" | "remove">("add");
  readonly floodAngleDeg = signal(30);
  readonly activeHandle = signal<string | null>(null);
  /** The pose that a gesture gives a handle while it goes on. */
  readonly dragged = signal<{ handle: string; pose: Pose } | null>(null);
  /** A reach being chosen; its region lights up. */
  readonly reachFor = signal<{ handle: string; reach: number } | null>(null);
  /** Counts changes of the model's steps. After one, points that were clicked before are off the surface. */
  readonly modelChanges = signal(0);
  /** The distance of two clicked points, model units; null if there are no two. */
  readonly measured = signal<number | null>(null);
  /** How strongly a selection is smoothed, flattened or inflated, up to 1. */
  readonly shapeStrength = signal(0.5);
  /** How far around a selection flattening and inflating fade out, model units; null: inside the selection. */
  readonly shapeReach = signal<number | null>(null);
  readonly movesPivot = signal(false); // a drag of the gizmo moves only the pivot
  readonly gizmoSpace = signal<"local" | "world">("local");
  readonly snap = signal(false);
  readonly snapMove = signal(0); // model units; 0: a hundredth of the diagonal
  readonly snapTurnDeg = signal(15);
  readonly snapScale = signal(0.1);
}
