#pragma once

#include <optional>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "resolve_deform.h"

namespace meshgraft {

/// A resolved deform step and the mesh at rest that it deforms.
struct ResolvedProblem {
  Points rest;          ///< n×3
  Triangles triangles;  ///< m×3
  ResolvedDeform deform;
};

/// Returns the same deformation on a mesh whose edges are halved `levels` times where free vertices meet
/// handles, fixed vertices or constraints (FT05 section 6: sparse boundaries). The old vertices come first
/// and keep their positions. A new vertex between two vertices of one handle, or between two fixed ones, is
/// held like them.
///
/// Without `levels`, the edges are halved twice around sparse handles and constraints. A connected piece of a
/// handle, or of the constrained vertices, is sparse if each of its vertices has a free neighbour. Curves are
/// never refined. The smallest pieces are taken, as long as they have at most 8 vertices together, or a
/// hundredth as many as are free; of pieces of one size all or none.
ResolvedProblem refine_boundary(ResolvedProblem problem, std::optional<int> levels, const Context& context);

}  // namespace meshgraft
