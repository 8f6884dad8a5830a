#pragma once

#include <vector>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/region.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A deformation to solve: a mesh at rest, the region that may move, and what constrains it. The region has
/// handles, or the problem has constraints per vertex, but not both.
struct DeformProblem {
  Points rest{};          ///< n×3, model units
  Triangles triangles{};  ///< m×3
  /// Vertices outside the region keep their positions and the transform I, unless `constraints` gives others.
  Region region{};
  /// Constraints per vertex in place of handles; at most one for each vertex. Their values are those of the
  /// first evaluation. Later evaluations may change the values, but not which positions and transforms are
  /// given.
  std::vector<VertexConstraint> constraints{};
};

}  // namespace meshgraft
