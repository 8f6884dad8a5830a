#pragma once

#include <memory>
#include <vector>

#include <nanobind/nanobind.h>

#include <meshgraft/operators/affine_operator.h>

#include "arrays.h"

namespace meshgraft::python {

/// Stands behind Python's AffineOperator.
struct OperatorHolder {
  std::shared_ptr<const AffineOperator> rows;
};

/// Returns (data, indices, offsets, (rows, columns)) of a compressed matrix, as SciPy takes them.
template <class Matrix>
nb::tuple sparse_parts(const Matrix& matrix) {
  using Offset = typename Matrix::StorageIndex;
  const auto count = static_cast<std::size_t>(matrix.nonZeros());
  const auto outer = static_cast<std::size_t>(matrix.outerSize()) + 1;
  return nb::make_tuple(array_of(std::vector<double>(matrix.valuePtr(), matrix.valuePtr() + count)),
                        array_of(std::vector<Offset>(matrix.innerIndexPtr(), matrix.innerIndexPtr() + count)),
                        array_of(std::vector<Offset>(matrix.outerIndexPtr(), matrix.outerIndexPtr() + outer)),
                        nb::make_tuple(matrix.rows(), matrix.cols()));
}

}  // namespace meshgraft::python
