#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/topology.h>

#include "patch.h"

namespace meshgraft {

/// The known parts of each vertex of a patch before the solve.
struct KnownParts {
  Flags position;
  Flags transform;
  std::vector<Index> feature;  ///< per vertex: index of its feature, or -1
  Flags anchored;              ///< a soft row pulls it to a target
};

/// Marks the transforms of connected components without a free position as known, because nothing depends on
/// them.
void fix_unconstrained_components(const IndexLists& rings, KnownParts& known);

/// Checks that the constraints of each connected free component fix an affine map: a position plus a
/// transform, or four positions that are not coplanar. Throws Error(unsolvable) with the id
/// deform.component_not_held or deform.component_held_by_positions. Isolated vertices do not count: they pass
/// through.
void require_solvable(const Patch& patch, const IndexLists& rings, const KnownParts& known);

}  // namespace meshgraft
