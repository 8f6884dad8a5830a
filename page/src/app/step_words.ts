import type { DocumentState } from "../protocol";

type Step = DocumentState["steps"][number];

export const stepKinds: Record<Step["kind"], string> = {
  deform: "Deform",
  merge: "Graft",
  cut: "Cut",
  repair: "Mend",
  sculpt: "Shape",
  transform: "Size and place",
};

/** Returns the name of a step, or its number and what it is about. */
export function stepTitle(step: Step, index: number, isOnlyMesh: boolean): string {
  return step.name ?? `${index + 1}. ${stepWords(stepKinds[step.kind], step, isOnlyMesh)}`;
}

/**
 * Returns the kind of a step with the meshes that it is about: "Graft: head on bust", "Cut: bust, gives bust 2". A model
 * that is the only mesh is not named.
 */
export function stepWords(kind: string, { fields }: Pick<Step, "fields">, isOnlyMesh = false): string {
  const { mesh, source, target, result } = fields as { mesh?: string; source?: string; target?: string; result?: string };
  if (source !== undefined && target !== undefined) return `${kind}: ${source} on ${target}`;
  if (mesh === undefined || isOnlyMesh) return kind;
  return `${kind}: ${mesh}${result === undefined || result === mesh ? "" : `, gives ${result}`}`;
}
