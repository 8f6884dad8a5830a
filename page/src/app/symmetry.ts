import { signal } from "@preact/signals";
import type { PageRequest } from "../protocol";
import { fieldsOf, type Failure } from "./wording";

/**
 * Largest distance between a vertex and another one's mirror image, × the model's diagonal. Used when symmetry is
 * turned on.
 */
export const mirrorTolerance = signal(1e-3);

/** Returns a tolerance in per cent of the model's diagonal, as the panel shows it. */
export function asPercent(tolerance_rel: number): number {
  return Number((100 * tolerance_rel).toPrecision(12));
}
export function fromPercent(percent: number): number {
  return Number((percent / 100).toPrecision(12));
}

/** Returns the tolerance that would suffice, if a failure names one. */
export function sufficientTolerance(failure: Failure): number | undefined {
  const fields =
    fieldsOf(failure, "script.no_mirror_image") ?? fieldsOf(failure, "script.vertex_without_mirror_image");
  return fields?.tolerance_rel;
}

/** Returns the requests that make a refused one succeed: a wider tolerance, then the request again. */
export function withTolerance(
  refused: PageRequest,
  tolerance_rel: number,
  plane: Extract<PageRequest, { do: "symmetry" }>["plane"],
): PageRequest[] {
  if (refused.do === "symmetry") return [{ ...refused, tolerance_rel }];
  return [{ do: "symmetry", ...(plane == null ? {} : { plane }), tolerance_rel }, refused];
}
