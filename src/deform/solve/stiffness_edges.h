#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/operators/affine_operator.h>

#include "operators/intrinsic_delaunay.h"

namespace meshgraft {

/// The share of an anchor's weight in its row. With it, weight 1 leaves about half of the anchors' motion
/// (docs/method.md, "Stationary anchors").
inline constexpr double anchor_share = 0.95;

/// The size of a connected component of free vertices.
struct FreeComponent {
  double area = 0;      ///< of the faces with a corner in it
  double vertices = 0;  ///< number of vertices, or of those that they stand for
};

/// Returns the factor of the stiffness μ in the rows of a component, beside `aware` rows of E_R. It is ℓ̄/D,
/// where ℓ̄ is the mean edge length and D = √area, or less on coarse components. At their border the balance of
/// stiffness and E_R leaves a layer of the width 1.9 D/μ. Where it is narrower than two edges, single edges
/// kink. The default stiffness is therefore reduced to a share; the square and the bound were chosen by rim
/// jumps (docs/methods.md). A smaller one is used as it is, but at most the reduced default. A larger one is
/// reduced to the same share. So more stiffness is never softer.
inline double stiffness_scale(double mean_edge_length, const FreeComponent& component, double stiffness) {
  constexpr double usual = DeformerOptions{}.stiffness;
  const double size = component.area > 0 ? std::sqrt(component.area) : 1;
  const double edges_across = std::sqrt(component.vertices * std::numbers::sqrt3 / 2);  // of equilateral faces
  const double needed = 1.05 * usual;  // edges across, for a layer of two edges
  const double reduction = std::clamp(std::pow(edges_across / needed, 2), 0.25, 1.0);
  return mean_edge_length / size * std::max(reduction, std::min(1.0, reduction * usual / stiffness));
}

/// Returns the factor of an edge: the mean of those of its ends that are free, where others have 0.
inline double edge_scale(double one, double other) {
  return one > 0 && other > 0 ? 0.5 * (one + other) : one + other;
}

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
