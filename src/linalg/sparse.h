#pragma once

#include <span>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "core/platform/processor.h"

namespace meshgraft {

/// A block of columns, e.g. three right-hand sides, stored row by row.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Computes a·b, row by row in parallel (Gustavson 1978). The order of every sum is fixed, so the result does
/// not depend on the number of threads. The columns of each row are sorted. Throws Error(input) with the
/// id linalg.operator_too_large when the product has 2³¹ or more non-zeros.
SparseRows multiply(const SparseRows& a, const SparseRows& b, const Context& context = {});

// In products with columns, a is compressed. The last bits depend on the vector instructions, which are by
// default the widest that the processor has.

/// Computes a·x for a block of columns, in parallel.
Columns multiply(const SparseRows& a, const Columns& x, const Context& context = {});

/// Computes y = a·x in the memory of y.
void multiply(const SparseRows& a, const Columns& x, Columns& y, const Context& context);

/// Computes a·x for columns first … first + count of x, and sets columns at … at + count of y.
void multiply_columns(const SparseRows& a, const Columns& x, Eigen::Index first, Eigen::Index count, Columns& y,
                      Eigen::Index at, const Context& context,
                      platform::VectorInstructions instructions = platform::vector_instructions());

/// Computes y ← y + a·x.
void add_product(const SparseRows& a, const Columns& x, Columns& y, const Context& context,
                 platform::VectorInstructions instructions = platform::vector_instructions());

/// Sets a matrix to another one without a copy. Eigen 3.4 has no move assignment.
inline void take_over(SparseRows& to, SparseRows from) { to.swap(from); }

/// Returns the rows of `top` followed by those of `bottom`.
SparseRows stack(const SparseRows& top, const SparseRows& bottom, const Context& context = {});

/// Computes aᵀ in parallel; columns of each row are sorted.
SparseRows transpose(const SparseRows& a, const Context& context = {});

/// Returns a matrix with `lengths[i]` entries in row i. Its entries are not yet written; columns must ascend.
SparseRows rows_of_lengths(std::span<const int> lengths, Eigen::Index columns);

}  // namespace meshgraft
