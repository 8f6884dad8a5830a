#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The parts of each vertex that are known before a solve, or shared with others. The vertices are those of a
/// mesh or of a patch of it. The mask has no values and no order; the solvers get both with the constraints.
struct ConstraintMask {
  Flags position;              ///< 1 where the position is known
  Flags transform;             ///< 1 where the local transform is known
  std::vector<Index> feature;  ///< index of the vertex's feature, or -1
  Flags anchored;              ///< 1 where a soft row draws the vertex to a target

  /// Makes a mask of no vertices, which an `AffineOperator` takes for a mesh without constraints.
  ConstraintMask() = default;
  /// Makes a mask of `count` vertices without features and anchors. All their positions and transforms are
  /// known, or none.
  ConstraintMask(Index count, bool known)
      : position(static_cast<std::size_t>(count), known),
        transform(static_cast<std::size_t>(count), known),
        feature(static_cast<std::size_t>(count), -1),
        anchored(static_cast<std::size_t>(count), 0) {}

  Index size() const { return static_cast<Index>(position.size()); }

  /// Returns whether the solve has to find the position or the transform.
  bool is_unknown(Index v) const { return !position[v] || !transform[v]; }
  /// Returns whether the local map is fitted to positions. Other maps are known or shared by a feature.
  bool is_fitted(Index v) const { return !transform[v] && feature[v] < 0; }
  /// Returns whether `DegenerateTreatment::ft05_noise` may move the vertex off its plane.
  bool is_movable(Index v) const { return !position[v] && is_fitted(v); }

  /// Returns the mask of the given vertices alone, in their order.
  ConstraintMask of(std::span<const Index> vertices) const {
    ConstraintMask some(static_cast<Index>(vertices.size()), false);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      some.position[i] = position[vertices[i]];
      some.transform[i] = transform[vertices[i]];
      some.feature[i] = feature[vertices[i]];
      some.anchored[i] = anchored[vertices[i]];
    }
    return some;
  }
};

}  // namespace meshgraft
