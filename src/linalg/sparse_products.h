#pragma once

#include <array>
#include <cstdint>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

// Sums of products, computed row by row in parallel like `multiply`, without storing each product. The order of
// every sum is fixed, so results do not depend on the number of threads.

/// The product a·b.
struct SparseProduct {
  const SparseRows& a;
  const SparseRows& b;
};

/// Computes a₁·b₁ − a₂·b₂. Throws Error(input) with the id linalg.operator_too_large when it has 2³¹ or more
/// non-zeros.
SparseRows difference_of_products(const SparseProduct& first, const SparseProduct& second,
                                  const Context& context = {});

/// Three matrices with entries at the same places.
using AlikeRows = std::array<SparseRows, 3>;

/// The products a·b·cₖ − d·eₖ for three matrices c and three matrices e.
struct AlikeTerms {
  const SparseRows& a;
  const SparseRows& b;
  const AlikeRows& c;
  const SparseRows& d;
  const AlikeRows& e;
};

/// Computes the three products. Throws Error(input) with the id linalg.operator_too_large when one has 2³¹ or
/// more non-zeros.
AlikeRows alike_products(const AlikeTerms& terms, const Context& context = {});

/// The normal equations' matrix AᵀA + Gᵀ K G for a symmetric K. Transposes are passed because they serve
/// right-hand sides, too.
struct NormalTerms {
  const SparseRows& A;
  const SparseRows& A_transposed;
  const SparseRows& G;
  const SparseRows& G_transposed;
  const SparseRows& K;
};

/// Computes the lower triangle of AᵀA + Gᵀ K G.
NormalMatrix normal_equations(const NormalTerms& terms, const Context& context = {});

/// Throws Error(input) with the id linalg.operator_too_large when there are 2³¹ or more entries.
void require_countable(std::int64_t entries);

}  // namespace meshgraft
