#pragma once

#include <cmath>
#include <numbers>

#include <meshgraft/operators/affine_operator.h>

#include "operators/intrinsic_delaunay.h"

namespace meshgraft {

/// The share of an anchor's weight in its row. With it, weight 1 leaves about half of the anchors' motion
/// (docs/method.md, "Stationary anchors").
inline constexpr double anchor_share = 0.95;

/// Calls `add(i, j, w)` for the rows w (x_i − x_j) of a stiffness. Beside rows of E_R that are integrals they
/// are those of the intrinsic Delaunay triangulation. Their sum of squares approximates 2 √3 weight² ∫ ‖∂x‖².
/// Beside FT05's rows they are the edges of the mesh, each with the weight itself.
template <class Add>
void visit_stiffness_edges(const AffineOperator& rows, double weight, const Add& add) {
  if (rows.intrinsic_edges()) {
    for (const auto& [ends, cotangent] : rows.intrinsic_edges()->edges)
      add(ends[0], ends[1], weight * std::sqrt(2 * std::numbers::sqrt3 * cotangent));
    return;
  }
  for (Index i = 0; i < rows.rings().size(); ++i)
    for (const Index j : rows.rings()[i])
      if (i < j) add(i, j, weight);
}

}  // namespace meshgraft
