#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/operators/affine_operator.h>

#include "linalg/sparse.h"
#include "linalg/sparse_products.h"

namespace meshgraft {

/// A field of maps F_v per vertex, and the local maps F̃_i of a surface with the gradient F, whose stencils have
/// the offsets ½(F_i + F_s)(p_s − p_i). F̃_i differs from F_i where a stencil is lopsided: its map is that of a
/// place beside the vertex. Without the difference, irregular triangles would leave the surface rough. F̃_i is
/// F_i at vertices without a fitted map, beside features, at whose ends F may jump, and everywhere if the rows
/// of E_R are FT05's.
class FittedField {
 public:
  /// `H` is that of `rows`, or a part of it. It may have rows that `mask` does not need.
  FittedField(const AffineOperator& rows, const SparseRows& H, const ConstraintMask& mask)
      : nodes_(rows.nodes()),
        points_(nodes_.positions),
        H_(H),
        mask_(mask),
        is_integral_(rows.intrinsic_edges() != nullptr) {}

  /// Returns F̃ − I for F − I. Rows 3v … 3v+2 are (F_v − I)ᵀ.
  Columns operator()(const Columns& field, const Context& context) const;
  /// Writes the same to the memory of `fitted`.
  void operator()(const Columns& field, Columns& fitted, const Context& context) const;
  /// Returns the rows (3n×n) of F̃ − I in terms of a number φ per vertex, where F − I = φ e_axis eᵀ, for each
  /// axis.
  AlikeRows along_axes(const Context& context) const;

 private:
  /// Calls `add(node, h, d)` for each vertex of the stencil: its column in the rows of H, and its offset.
  template <class Add>
  void visit_stencil(Index vertex, const Add& add) const;
  Eigen::Matrix3d half_tangential(Index vertex) const;
  template <int width>
  Eigen::Matrix<double, 3, width> rows_of(Index vertex, const Columns& field) const;
  bool is_fitted(Index vertex) const;

  const StencilNodes& nodes_;
  const Points& points_;
  const SparseRows& H_;
  const ConstraintMask& mask_;
  bool is_integral_;
};

/// Returns ½ (I − n nᵀ). Σ_s h_s d_sᵀ = I, so that F̃_i = F_i + ½ Σ_s (F_s − F_i) d_s h_sᵀ. The normal n keeps
/// its image F_i n: h_s counts without its part along n.
inline Eigen::Matrix3d FittedField::half_tangential(Index vertex) const {
  const Eigen::Vector3d n = (points_.row(nodes_.apex[vertex]) - points_.row(vertex)).normalized();
  return (Eigen::Matrix3d::Identity() - n * n.transpose()) / 2;
}

template <class Add>
void FittedField::visit_stencil(Index vertex, const Add& add) const {
  SparseRows::InnerIterator x(H_, 3 * vertex), y(H_, 3 * vertex + 1), z(H_, 3 * vertex + 2);
  for (; x; ++x, ++y, ++z) {
    const auto node = static_cast<Index>(x.col());
    if (node >= mask_.size() || node == vertex) continue;
    const Eigen::Vector3d h(x.value(), y.value(), z.value());
    add(node, h, points_.row(node) - points_.row(vertex));
  }
}

}  // namespace meshgraft
