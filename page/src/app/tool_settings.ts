import { signal } from "@preact/signals";
import type { Pose } from "../protocol";

/** What a drag on the surface does. A drag beside it turns the view, but with lasso and box. */
export type ToolName =
  | "navigate"
  | "handle" // paint a handle; a region of a reach appears around it
  | "brush"
  | "lasso"
  | "box"
  | "connected"
  | "loop"
  | "flood"
  | "vertex" // a handle of one vertex
  | "curve"; // a handle along shortest paths between clicked points

/** The tools' settings: panels change them, tools read them. Lengths in pixels are of the page's. */
export class ToolSettings {
  readonly tool = signal<ToolName>("navigate");
  readonly brushRadiusPx = signal(24);
  readonly through = signal(false); // selects what lies behind, too
  readonly combine = signal<"set" | "add" | "remove">("add");
  readonly floodAngleDeg = signal(30);
  readonly activeHandle = signal<string | null>(null);
  /** Where a gesture has a handle, while it goes on. */
  readonly dragged = signal<{ handle: string; pose: Pose } | null>(null);
  /** A reach that is being chosen: what it comes to lights up. */
  readonly reachFor = signal<{ handle: string; reach: number } | null>(null);
  readonly movesPivot = signal(false); // a drag of the gizmo moves the pivot, and nothing else
  readonly gizmoSpace = signal<"local" | "world">("local");
  readonly snap = signal(false);
  readonly snapMove = signal(0); // model units; 0: a hundredth of the diagonal
  readonly snapTurnDeg = signal(15);
  readonly snapScale = signal(0.1);
}
