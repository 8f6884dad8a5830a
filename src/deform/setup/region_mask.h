#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// Returns the mask of a region without its handles, features and anchors. Vertices outside the region and
/// fixed vertices are known, all others are unknown. Throws Error(input) for a vertex that does not exist.
ConstraintMask mask_of_region(Index count, const Region& region);

/// The constrained vertices in the order in which their values come with each evaluation. A `ConstraintMask`
/// has no such order, and does not tell a constrained vertex from a fixed one.
struct ConstraintList {
  std::vector<Index> vertex;
  Flags gives_position, gives_transform;

  std::size_t size() const { return vertex.size(); }
  /// Throws Error(usage) if the constraints do not match the list, Error(input) if a value cannot be used.
  void require_matching(std::span<const VertexConstraint> constraints) const;
};

/// Returns the mask of a mesh with `count` vertices, and lists in `constrained` the vertices of the handles, or
/// else of the constraints. Throws Error(input) for errors in the region, its handles, features and anchors, or
/// in the constraints. Throws Error(usage) if there are both handles and constraints.
ConstraintMask make_mask(Index count, const Region& region, std::span<const VertexConstraint> constraints,
                         ConstraintList& constrained);

}  // namespace meshgraft
