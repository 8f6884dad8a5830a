import type { FactFields, FactId } from "../../facts";
import { formatNumber } from "../units";
import type { GraftFields } from "./graft_step";

/** A change of the graft that mends what an error or a note tells of, with the label of its button. */
export interface GraftRemedy {
  readonly label: string;
  readonly fields: GraftFields;
}

const useSize = (size: number): GraftRemedy => ({ label: `Use size ${formatNumber(size, 3)}`, fields: { size } });
const flipNormals = (): GraftRemedy => ({ label: "Flip normals of part", fields: { fix_winding: true } });
const clearFixed = (): GraftRemedy => ({ label: "Clear fixed area", fields: { fixed: null } });

const remedies: { [Id in FactId]?: (fields: FactFields[Id]) => GraftRemedy } = {
  "merge.boundary_ragged": () => ({ label: "Smooth ragged loops", fields: { smooth_boundary: true } }),
  "merge.fixed_on_loop": clearFixed,
  "merge.intersection_avoided_if_smaller": ({ smaller_size }) => useSize(smaller_size),
  "merge.matches_cross": flipNormals,
  "merge.no_hole": ({ largest }) => useSize(largest),
  "merge.orientations_disagree": flipNormals,
  "merge.pairs_invert_source": () => ({ label: "Keep the first try", fields: { retry: false } }),
  "merge.size_makes_source_huge": ({ same_size }) => useSize(same_size),
  "merge.size_makes_source_tiny": ({ same_size }) => useSize(same_size),
  "merge.size_too_small": ({ least }) => useSize(least),
  "merge.source_shrunk": () => ({ label: "Use tilt -45°", fields: { normal_angle_deg: -45 } }),
  "merge.source_stretched": () => ({
    label: "Place automatically",
    fields: { pose: null, source_transform: null, fixed: null },
  }),
  "merge.source_too_small": ({ least }) => useSize(least),
  "script.fixed_empty": clearFixed,
};

/** Returns the change of the graft that mends what a fact tells of; undefined if there is none. */
export function graftRemedy({ id, fields }: { id: string; fields: object }): GraftRemedy | undefined {
  const remedy = (remedies as Record<string, ((fields: object) => GraftRemedy) | undefined>)[id];
  return remedy?.(fields);
}
