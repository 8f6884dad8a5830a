import { signal } from "@preact/signals";
import type { EngineError, PageRequest } from "../protocol";

/**
 * Largest distance between a vertex and another one's mirror image, × the model's diagonal. Used when symmetry is
 * turned on.
 */
export const mirrorTolerance = signal(1e-3);

/** Returns the tolerance that would suffice, if a refusal names one. */
export function sufficientTolerance({ remedy }: EngineError): number | undefined {
  const found = /'symmetry\.tolerance_rel' of ([\d.]+(?:e[+-]?\d+)?)/.exec(remedy)?.[1];
  const tolerance = Number(found);
  return found !== undefined && tolerance > 0 ? tolerance : undefined;
}

/** Rewrites the engine's errors about symmetry in the words of the panels. Other errors stay as they are. */
export function inSymmetryWords(error: EngineError): EngineError {
  const tolerance = sufficientTolerance(error);
  const { problem, remedy } = error;
  if (tolerance !== undefined) {
    return {
      ...error,
      problem: lostBy(problem) ?? "a vertex lacks a mirror image",
      location: "",
      remedy: `The model is not quite the same on both sides. With a tolerance of ${tolerance} each finds a partner; or hold something else.`,
    };
  }
  if (remedy.startsWith("Choose a plane that mirrors")) {
    const lost = lostBy(problem);
    return {
      ...error,
      problem: lost ?? problem,
      location: "",
      remedy: "The model is not the same on both sides of this plane. Move the plane or choose another axis, under Symmetry.",
    };
  }
  if (problem.includes("overlaps its mirror image"))
    return { ...error, location: "", remedy: "Keep it on one side of the plane, or move the plane under Symmetry." };
  if (remedy.includes("symmetry.tolerance_rel"))
    return { ...error, location: "", remedy: "Make the tolerance smaller, under Symmetry, or draw the curve elsewhere." };
  return error;
}

function lostBy(problem: string): string | undefined {
  const lost = /^(\d+) of the (\d+) vertices of the handle '(.*)' have/.exec(problem);
  return lost === null ? undefined : lackWords(Number(lost[1]), Number(lost[2]), lost[3] ?? "");
}

function lackWords(lost: number, all: number, handle: string): string {
  const who = lost === all ? (all === 1 ? "the vertex" : `all ${all} vertices`) : `${lost} of the ${all} vertices`;
  return `${who} of “${handle}” ${lost === 1 ? "lacks" : "lack"} a mirror image`;
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
