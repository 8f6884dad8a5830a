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

Columns FittedField::operator()(const Columns& field, const Context& context) const {
  Columns fitted = Columns::Zero(field.rows(), field.cols());
  parallel_blocks(
      static_cast<std::size_t>(mask_.size()),
      [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v)
          for (int axis = 0; axis < 3; ++axis)
            visit(v, axis, [&](Index of, int a, double weight) {
              fitted.row(3 * v + axis) += weight * field.row(3 * of + a);
            });
      },
      context, 1024);
  return fitted;
}

}  // namespace meshgraft
