import { Matrix4 } from "three";
import type { Graft } from "../../app/graft/graft";
import { matrixOfRows, rowsOfMatrix } from "../../view/graft/graft_view";
import type { Viewport } from "../../view/viewport";
import type { Movable, Moved } from "../movable";
import { matrixOf, type Placement } from "../pose_math";

const name = "part";

/** Poses the part of a graft that keeps its pose (`source_transform`), by the gizmo. */
export class PartControl implements Movable {
  /** The placement from the gizmo's gestures, valid as long as the document has the same transform. */
  private own: { readonly placement: Placement; readonly rows: string } | undefined;

  constructor(
    private readonly viewport: Viewport,
    private readonly graft: Graft,
  ) {}

  get active(): Moved | undefined {
    const { mode, tool, step, source } = this.graft;
    const shown = step.value;
    const surface = this.viewport.surfaceOf(source.value?.mesh ?? -1);
    if (mode.value !== "graft" || tool.value !== "loops" || shown?.pose !== "keep" || surface === undefined) return undefined;
    const defaultPivot = surface.sphere().center;
    const matrix = shown.sourceTransform === undefined ? new Matrix4() : matrixOfRows(shown.sourceTransform);
    const rows = JSON.stringify(rowsOfMatrix(matrix));
    const placement: Placement =
      this.own?.rows === rows ? this.own.placement : { kind: "affine", matrix, pivot: defaultPivot };
    return { name, placement, defaultPivot };
  }

  show(_name: string, placement: Placement): void {
    const rows = rowsOfMatrix(matrixOf(placement));
    this.own = { placement, rows: JSON.stringify(rows) };
    if (this.graft.step.value?.mirror === undefined) this.graft.transform.value = rows;
    this.graft.drag({ source_transform: rows });
    this.viewport.requestRender();
  }

  async commit(_name: string, placement: Placement): Promise<void> {
    this.show(name, placement);
    await this.graft.keepDragged();
  }

  revert(): void {
    this.own = undefined;
    void this.graft.forgetDragged();
  }
}
