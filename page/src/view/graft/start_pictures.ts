import { Matrix4, Vector3 } from "three";
import type { Graft } from "../../app/graft/graft";
import type { Pair, StartCandidate } from "../../app/graft/graft_step";
import type { Surface } from "../surface/surface";
import type { Viewport } from "../viewport";
import { matrixOfRows } from "./graft_view";

const modelColour = [0.78, 0.75, 0.71] as const;
const partColour = [0.95, 0.62, 0.3] as const;
const pixels = 160; // shown at half of it

/** Makes small pictures of the rotations that a user may have meant: the part on the model, before it bends. */
export class StartPictures {
  private readonly made = new Map<string, Promise<string>>();

  constructor(
    private readonly viewport: Viewport,
    private readonly graft: Graft,
  ) {}

  /** Returns a picture as a data URL; undefined while the placement of the part is not known. */
  picture(pair: Pair, candidate: StartCandidate): Promise<string> | undefined {
    const { source, target, report } = this.graft;
    const part = this.viewport.surfaceOf(source.value?.mesh ?? -1);
    const model = this.viewport.surfaceOf(target.value?.mesh ?? -1);
    const curves = this.graft.starts.curvesOf(pair);
    const placed = report.value?.transform;
    if (part === undefined || model === undefined || curves === undefined || placed === undefined) return undefined;
    const key = [part.id, model.id, pair.sourceLoop, pair.targetLoop, String(placed), ...candidate.start].join(" ");
    const known = this.made.get(key);
    if (known !== undefined) return known;
    const matrix = rotatedPlacement(matrixOfRows(placed), part, model, curves.target.vertices, candidate.start as [number, number]);
    const around = part.sphere().applyMatrix4(matrix);
    around.radius *= 1.1;
    const picture = this.viewport.smallPicture({
      shown: [
        { surface: model, matrix: new Matrix4(), colour: modelColour },
        { surface: part, matrix, colour: partColour },
      ],
      around,
      pixels,
    });
    this.made.set(key, picture);
    picture.catch(() => this.made.delete(key)); // it is made again
    return picture;
  }
}

/**
 * Returns the placement of a part after a rotation about the axis of the model's loop that brings the part's start to
 * the model's.
 */
function rotatedPlacement(placed: Matrix4, part: Surface, model: Surface, loop: Uint32Array, [source, target]: [number, number]): Matrix4 {
  const { centre, axis } = axisOf(model, loop);
  const across = (point: Vector3) => point.sub(centre).projectOnPlane(axis);
  const from = across(part.positionOf(source).applyMatrix4(placed));
  const to = across(model.positionOf(target));
  const angle = Math.atan2(new Vector3().crossVectors(from, to).dot(axis), from.dot(to));
  const turn = new Matrix4().makeRotationAxis(axis, angle);
  const back = new Matrix4().makeTranslation(centre.clone().negate());
  return new Matrix4().makeTranslation(centre).multiply(turn).multiply(back).multiply(placed);
}

/** Returns the mean of a loop's vertices and the unit normal of the area that it spans. */
function axisOf(surface: Surface, loop: Uint32Array): { centre: Vector3; axis: Vector3 } {
  const points = Array.from(loop, (v) => surface.positionOf(v));
  const centre = points.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(Math.max(1, points.length));
  const axis = new Vector3();
  points.forEach((point, k) => {
    const next = points[(k + 1) % points.length] ?? point;
    axis.add(new Vector3().crossVectors(point.clone().sub(centre), next.clone().sub(centre)));
  });
  return { centre, axis: axis.normalize() };
}
