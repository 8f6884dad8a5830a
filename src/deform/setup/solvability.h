#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

#include "patch.h"

namespace meshgraft {

/// Marks the transforms of connected components without a free position as known, because nothing depends on
/// them.
void fix_unconstrained_components(const IndexLists& rings, ConstraintMask& mask);

/// Checks that the constraints of each connected free component fix an affine map: a position plus a
/// transform, or four positions that are not coplanar. Throws Error(unsolvable) with the id
/// deform.component_not_held or deform.component_held_by_positions. Isolated vertices do not count: they pass
/// through.
void require_solvable(const Patch& patch, const IndexLists& rings, const ConstraintMask& mask);

/// Performs the check that `Deformer` makes before assembly, on a whole mesh. Throws Error(unsolvable) if the
/// constraints do not determine a connected free component.
void require_solvable(const Points& rest, const Triangles& triangles, const ConstraintMask& mask,
                      const Context& context);

}  // namespace meshgraft
