#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The unknowns of a matrix, gathered in nodes of up to `width` rows: those of one group, two at most. One that
/// has no group is a node by itself. A row without an unknown pads its node.
struct BlockRows {
  Index count = 0;
  int width = 1;             ///< 1 or 2
  std::vector<int> row;      ///< of each unknown: width · node + its index in the node
  std::vector<int> unknown;  ///< of each row, or -1
  Flags shared;              ///< of each node: it has no group, or is coupled with nearly all
  Points positions;          ///< of each row; of padding the node's first one's
};

/// The order in which sweeps go through the nodes, as parallel as it can be with a result that does not depend
/// on the number of threads. Nodes are numbered strip by strip; no entry of the matrix couples two even strips,
/// or two odd ones, and an odd strip reaches only one end of an even one. So first all even strips are gone
/// through at once, then all odd ones; backward the other way round.
struct SweepColouring {
  std::vector<Index> begin{0};  ///< strips + 1
  Index size() const { return static_cast<Index>(begin.size()) - 1; }
};

/// Nodes numbered for sweeps, with what the matrix and the ordering graph say of their neighbourhoods.
struct NodeOrder {
  BlockRows nodes;
  SweepColouring strips;
  // Of each node, those coupled with it that a forward sweep meets first; ascending. Far ones often have one
  // entry in common, that of both nodes' first rows.
  IndexLists before_by_block;
  IndexLists before_by_entry;
  IndexLists neighbours;  ///< in the ordering graph, or where there is none in the matrix; none of shared nodes
  bool has_graph = false;
};

NodeOrder order_nodes(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context = {});

}  // namespace meshgraft
