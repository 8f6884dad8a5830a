#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// A nested dissection: sets of unknowns in a binary tree. Unknowns of two sets are coupled only if one set
/// is an ancestor of the other.
struct Dissection {
  std::vector<int> parent;  ///< per set, -1 at the root; all descendants come before their ancestors
  std::vector<std::vector<int>> unknowns;  ///< per set, ascending
  std::vector<int> set_of;                 ///< per unknown

  int sets() const { return static_cast<int>(parent.size()); }
  bool is_leaf(int set) const { return set == 0 || parent[set - 1] != set; }
};

/// Returns whether a graph is known, and the matrix is large enough for dissection by it.
bool is_worth_dissecting(const OrderingGraph& graph);

/// Dissects a matrix by the cuts of an ordering graph. Bisecting the graph (METIS) is quick because it is
/// small. Each cut's separator is the smallest set of unknowns that touches all entries of the matrix across
/// the cut. It is therefore as thick as the matrix's couplings are long. Separators of the graph itself would
/// be thinner and leave the sides coupled, with four times the fill.
Dissection dissect(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context = {});

/// Returns a dissection without cuts: all `unknowns` are in one set, a leaf.
Dissection one_leaf(std::int64_t unknowns);

}  // namespace meshgraft
