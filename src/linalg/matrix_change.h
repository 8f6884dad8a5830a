#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// Describes how a symmetric matrix N changes when some of its unknowns are removed.
struct MatrixChange {
  /// The lower triangle of the difference, by the unknowns of N. Its entries are at places where N has some. A
  /// removed unknown keeps its diagonal and loses all other entries.
  NormalMatrix difference;
  std::vector<int> number;  ///< per unknown of N: its number in the changed matrix, or -1 if it is removed
};

/// The rows of normal equations AᵀA + Gᵀ K G.
struct RowsOfNormal {
  const SparseRows& A;
  const SparseRows& G;
};

/// Compares the rows of two least-squares problems with the same K, and returns how their normal equations
/// differ. `K` is called if they differ little. `number` ascends where unknowns stay. Returns nullopt if
/// `after` has an unknown or an entry that `before` does not have, or if more than a quarter of the rows
/// differ.
std::optional<MatrixChange> change_of_normal(const RowsOfNormal& before, const RowsOfNormal& after,
                                             const std::function<SparseRows()>& K, std::vector<int> number,
                                             const Context& context);

}  // namespace meshgraft
