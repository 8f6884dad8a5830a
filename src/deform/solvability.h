#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/topology.h>

#include "patch.h"

namespace meshgraft {

/// What is known of each vertex of a patch before the solve.
struct KnownParts {
  Flags position;
  Flags transform;
  std::vector<Index> feature;  ///< number of its feature, or -1
  Flags anchored;              ///< drawn to a place by a soft row
};

/// Marks the transforms of components without a free position as known: nothing depends on them.
void fix_unconstrained_components(const IndexLists& rings, KnownParts& known);

/// Checks that the constraints of each connected free component fix an affine map: a position plus a
/// transform, or four positions that are not coplanar. Throws Error(unsolvable) naming the component and
/// what to add. Isolated vertices do not count: they pass through.
void require_solvable(const Patch& patch, const IndexLists& rings, const KnownParts& known);

}  // namespace meshgraft
