#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "dissection.h"

namespace meshgraft {

/// The supernodes of a Cholesky factorisation and the rows of their columns in the factor. A supernode is a
/// set of unknowns that are eliminated together. Positions count in the elimination order.
struct SupernodalPattern {
  std::vector<int> order;                ///< the unknown at each position
  std::vector<int> first_position;       ///< per supernode; one more at the end
  std::vector<std::int64_t> rows_begin;  ///< per supernode: its first index in `rows`; one more at the end
  std::vector<int> rows;                 ///< positions, ascending; a supernode's own come first

  int supernodes() const { return static_cast<int>(first_position.size()) - 1; }
  double factor_nonzeros() const;  ///< includes explicit zeros that merging stores
  double flops() const;            ///< Σ (non-zeros of the column)²
};

/// The lower triangle of a matrix by positions: the rows below each column, unsorted.
struct LowerEntries {
  std::vector<std::int64_t> begin;
  std::vector<int> row;
  std::vector<double> value;  ///< may be empty
};
LowerEntries permute(const NormalMatrix& lower, std::span<const int> inverse_permutation, bool with_values,
                     const Context& context);

/// Orders each leaf of a dissection by minimum degree (Amestoy, Davis & Duff 1996), with degrees that include
/// the unknowns around it. Then finds the supernodes. A separator is one supernode. A leaf has those of its
/// elimination, merged where this stores few zeros.
SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const Dissection& dissection,
                                         const Context& context);

/// Finds the supernodes of an elimination in a given order, merged in the same way. The pattern's order may
/// differ but gives the same factor. It is a postorder of the elimination tree, which places columns with
/// similar rows next to each other.
SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const std::vector<int>& order,
                                         const Context& context);

}  // namespace meshgraft
