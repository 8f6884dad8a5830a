// What a graft is made of, as the page knows it.
import type { Outcome } from "../../engine/connection";
import type { DocumentState, EngineError, EngineEvent, PageRequest, Plane, SelectionSpec } from "../../protocol";
import type { LoopCurve } from "./loop_curve";

export type GraftReport = Extract<EngineEvent, { event: "graft" }>;
export type PartSource = { path: string } | { sample: string; resolution?: number } | { upload: string };
export type GraftTool = "loops" | "plane" | "stroke" | "fixed" | "drop";
/** How the two are shown: what comes of them, that with the part beside it, or both as they were. */
export type Arrangement = "result" | "both" | "apart";

/** The model or a part, as the engine lists it. */
export interface MeshObject {
  name: string;
  mesh: number;
  vertices: number;
  faces: number;
  loops: number;
  diagonal: number;
  grafted: boolean;
}

/** A boundary loop as it is shown. */
export interface ShownLoop {
  readonly vertices: Uint32Array; // in order
  readonly length: number;
  readonly curve: LoopCurve;
}

/** A plane that is to cut a mesh, in that mesh's own coordinates. */
export interface Cut {
  readonly mesh: number;
  readonly plane: Plane;
}

/** A curve that is being drawn to cut along: through these vertices of a mesh. */
export interface DrawnCurve {
  readonly mesh: number;
  readonly vertices: readonly number[];
  readonly closed: boolean;
}

export type SelectionChange =
  { how: "invert" } | { how: "grow"; rings: number } | { how: "set"; what: SelectionSpec };
export type CutRequest = Extract<PageRequest, { do: "cut" }>;
export type Side = "above" | "below" | "both";

export interface LoopRef {
  readonly mesh: number;
  readonly loop: number;
}

/** What a graft needs of the editor. */
export interface GraftHost {
  readonly state: { readonly value: DocumentState | null };
  ask(request: PageRequest): Promise<Outcome | undefined>;
  attempt(request: PageRequest): Promise<Outcome | EngineError>;
  request(request: PageRequest): Promise<Outcome>;
  /** Tells the person something that is no failure. */
  note(problem: string, remedy: string): void;
  /** Where the vertices of a mesh are, 3 numbers each. */
  positionsOf(mesh: number): Float32Array | undefined;
}
