// The data types of a graft in the page.
import type { Outcome } from "../../engine/connection";
import type { DocumentState, EngineEvent, PageRequest, EditSelection } from "../../protocol";
import type { PageRemedy } from "../remedies";
import type { Failure } from "../wording";
import type { LoopCurve } from "./loop_curve";

export type GraftReport = Extract<EngineEvent, { event: "graft" }>;
export type PartSource = { path: string } | { sample: string; resolution?: number } | { upload: string };
export type GraftTool = "loops" | "plane" | "stroke" | "fixed" | "drop";
/** The objects shown: the result, the result and the part, or both objects as they were. */
export type Arrangement = "result" | "both" | "apart";

/** The model or a part, as listed by the engine. */
export interface MeshObject {
  name: string;
  mesh: number;
  vertices: number;
  faces: number;
  loops: number;
  diagonal: number;
  grafted: boolean;
}

/** A boundary loop as shown in the view. */
export interface ShownLoop {
  readonly vertices: Uint32Array; // in order along the loop
  readonly length: number;
  readonly curve: LoopCurve;
}

export type SelectionChange =
  { how: "invert" } | { how: "grow"; rings: number } | { how: "set"; what: EditSelection };

export interface LoopRef {
  readonly mesh: number;
  readonly loop: number;
}

/** The functions of the editor that a graft uses. */
export interface GraftHost {
  readonly state: { readonly value: DocumentState | null };
  ask(request: PageRequest): Promise<Outcome | undefined>;
  attempt(request: PageRequest): Promise<Outcome | Failure>;
  request(request: PageRequest): Promise<Outcome>;
  /** Tells the user something that is not a failure. An undo removes the message if `of` names a request. */
  note(problem: string, remedy: string, offered?: PageRemedy, of?: PageRequest["do"]): void;
  /** Returns the positions of a mesh's vertices, 3 numbers each. */
  positionsOf(mesh: number): Float32Array | undefined;
}
