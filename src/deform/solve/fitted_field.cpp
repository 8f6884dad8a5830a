#include "fitted_field.h"

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

}  // namespace meshgraft
