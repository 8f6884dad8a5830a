#include "fitted_field.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace meshgraft {

/// Returns whether the map of F at a vertex is fitted to its stencil.
bool FittedField::is_fitted(Index vertex) const {
  SparseRows::InnerIterator it(H_, 3 * vertex);
  if (!is_integral_ || !mask_.is_fitted(vertex) || nodes_.apex[vertex] < 0 || !it) return false;
  for (; it; ++it)
    if (it.col() < mask_.size() && mask_.feature[it.col()] >= 0) return false;
  return true;
}

/// Returns the three rows of one vertex. `width` is the number of columns.
template <int width>
Eigen::Matrix<double, 3, width> FittedField::rows_of(Index vertex, const Columns& field) const {
  using Rows = Eigen::Matrix<double, 3, width>;
  const Rows own = field.middleRows<3>(3 * vertex);
  if (!is_fitted(vertex)) return own;
  Rows sum = Rows::Zero(3, field.cols());
  visit_stencil(vertex, [&](Index node, const Eigen::Vector3d& h, const Eigen::RowVector3d& offset) {
    const Eigen::Matrix<double, 1, width> change = offset * (field.middleRows<3>(3 * node) - own);
    sum += h * change;
  });
  return own + half_tangential(vertex) * sum;
}

Columns FittedField::operator()(const Columns& field, const Context& context) const {
  Columns fitted;
  (*this)(field, fitted, context);
  return fitted;
}

void FittedField::operator()(const Columns& field, Columns& fitted, const Context& context) const {
  fitted.resize(field.rows(), field.cols());
  parallel_blocks(
      static_cast<std::size_t>(mask_.size()),
      [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
          if (field.cols() == 3)
            fitted.middleRows<3>(3 * v) = rows_of<3>(v, field);
          else
            fitted.middleRows<3>(3 * v) = rows_of<Eigen::Dynamic>(v, field);
        }
      },
      context, 1024);
}

AlikeRows FittedField::along_axes(const Context& context) const {
  const Index n = mask_.size();
  const auto for_vertices = [&](const auto& body) {
    parallel_blocks(
        static_cast<std::size_t>(n),
        [&](std::size_t begin, std::size_t end) {
          for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) body(v);
        },
        context, 1024);
  };
  std::vector<int> lengths(3 * static_cast<std::size_t>(n), 1);
  for_vertices([&](Index v) {
    if (!is_fitted(v)) return;
    int others = 0;
    visit_stencil(v, [&](Index, const Eigen::Vector3d&, const Eigen::RowVector3d&) { ++others; });
    std::fill_n(lengths.begin() + 3 * v, 3, 1 + others);
  });
  AlikeRows axes;
  for (SparseRows& rows : axes) take_over(rows, rows_of_lengths(lengths, n));
  for_vertices([&](Index v) {
    const int length = lengths[3 * v];
    int at = axes[0].outerIndexPtr()[3 * v];
    const auto set = [&](Index column, const Eigen::Matrix3d& weights) {
      for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < 3; ++k) {
          axes[axis].innerIndexPtr()[at + k * length] = column;
          axes[axis].valuePtr()[at + k * length] = weights(k, axis);
        }
      ++at;
    };
    Eigen::Matrix3d own = Eigen::Matrix3d::Identity();
    if (length == 1) return set(v, own);
    const Eigen::Matrix3d half = half_tangential(v);
    const auto weights = [&](const Eigen::Vector3d& h, const Eigen::RowVector3d& offset) {
      return Eigen::Matrix3d(half * h * offset);
    };
    visit_stencil(v, [&](Index, const Eigen::Vector3d& h, const Eigen::RowVector3d& offset) {
      own -= weights(h, offset);
    });
    bool is_own_set = false;
    visit_stencil(v, [&](Index node, const Eigen::Vector3d& h, const Eigen::RowVector3d& offset) {
      if (node > v && !std::exchange(is_own_set, true)) set(v, own);
      set(node, weights(h, offset));
    });
    if (!is_own_set) set(v, own);
  });
  return axes;
}

}  // namespace meshgraft
