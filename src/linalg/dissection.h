#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// A nested dissection: sets of unknowns in a binary tree. Unknowns of two sets are coupled only if one of the
/// sets lies below the other.
struct Dissection {
  std::vector<int> parent;  ///< of each set, -1 at the root; every set comes after those below it
  std::vector<std::vector<int>> unknowns;  ///< of each set, ascending
  std::vector<int> set_of;                 ///< of each unknown

  int sets() const { return static_cast<int>(parent.size()); }
  bool is_leaf(int set) const { return set == 0 || parent[set - 1] != set; }
};

/// Dissects a matrix by the cuts of a ordering graph. The graph is bisected (METIS), which is quick because it
/// is small; each cut's separator is then the fewest unknowns that touch all entries of the matrix across the
/// cut, hence as thick as the matrix's couplings are long. Separators as thin as the graph's own would leave
/// sides coupled, with four times the fill.
Dissection dissect(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context = {});

/// Returns a dissection of `unknowns` that cuts nothing: they are all in one set, a leaf.
Dissection one_leaf(std::int64_t unknowns);

}  // namespace meshgraft
