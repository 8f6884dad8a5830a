#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "dissection.h"

namespace meshgraft {

/// Which unknowns a Cholesky factorisation eliminates together, and which rows their columns of the factor
/// have. Positions count in the order of elimination.
struct SupernodalPattern {
  std::vector<int> order;                ///< the unknown at each position
  std::vector<int> first_position;       ///< of each supernode; one more at the end
  std::vector<std::int64_t> rows_begin;  ///< of each supernode in `rows`; one more at the end
  std::vector<int> rows;                 ///< positions, ascending; a supernode's own come first

  int supernodes() const { return static_cast<int>(first_position.size()) - 1; }
  double factor_nonzeros() const;  ///< zeros that are stored for a simpler structure are counted
  double flops() const;            ///< Σ (non-zeros of the column)²
};

/// A matrix's lower triangle by positions: for each column the rows below, in no order.
struct LowerEntries {
  std::vector<std::int64_t> begin;
  std::vector<int> row;
  std::vector<double> value;  ///< may be left out
};
LowerEntries permute(const NormalMatrix& lower, std::span<const int> inverse_permutation, bool with_values,
                     const Context& context);

/// Orders each leaf of a dissection by minimum degree (Amestoy, Davis & Duff 1996), the unknowns around it in
/// view, and finds the supernodes: a separator is one, leaves have those of their elimination, merged where few
/// zeros are stored for it.
SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const Dissection& dissection,
                                         const Context& context);

/// Finds the supernodes of an elimination in a given order, merged in the same way. The pattern's order is
/// another one with the same factor: a postorder of the elimination tree, which leaves columns of like rows
/// side by side.
SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const std::vector<int>& order,
                                         const Context& context);

}  // namespace meshgraft
