#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// A sparse matrix by rows, the form in which all operators are kept.
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

/// Columns that belong together, e.g. three right-hand sides, stored row by row.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// a·b, row by row in parallel (Gustavson 1978); the order of every sum is fixed, so the result does not
/// depend on the number of threads. Columns of each row come out sorted. Throws Error(input) when the
/// product has 2³¹ or more non-zeros.
SparseRows multiply(const SparseRows& a, const SparseRows& b, const Context& context = {});

/// a₁·b₁ − a₂·b₂ in the same way.
SparseRows difference_of_products(const SparseRows& a1, const SparseRows& b1, const SparseRows& a2,
                                  const SparseRows& b2, const Context& context = {});

/// Lower triangle of AᵀA + Gᵀ K G, K symmetric.
NormalMatrix normal_equations(const SparseRows& A_transposed, const SparseRows& A,
                              const SparseRows& G_transposed, const SparseRows& K, const SparseRows& G,
                              const Context& context = {});

/// a·x for a block of columns, in parallel.
Columns multiply(const SparseRows& a, const Columns& x, const Context& context = {});

/// The rows of `top`, then those of `bottom`.
SparseRows stack(const SparseRows& top, const SparseRows& bottom);

SparseRows transpose(const SparseRows& a, const Context& context = {});

/// A matrix whose rows have so many entries each, still to be written (columns ascending).
SparseRows rows_of_lengths(std::span<const int> lengths, Eigen::Index columns);

}  // namespace meshgraft
