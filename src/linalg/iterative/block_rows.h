#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The unknowns of a matrix, gathered in nodes of up to `width` rows. A node holds at most two unknowns of
/// one group. An unknown without a group is a node by itself. A row without an unknown pads its node.
struct BlockRows {
  Index count = 0;
  int width = 1;             ///< 1 or 2
  std::vector<int> row;      ///< per unknown: width · node + its index in the node
  std::vector<int> unknown;  ///< per row, or -1 for padding
  Flags shared;              ///< per node: it has no group, or is coupled with nearly all others
  Points positions;          ///< per row; padding has the position of the node's first row
};

/// The order in which sweeps visit the nodes. It is as parallel as possible, with a result that does not
/// depend on the number of threads. Nodes are numbered strip by strip. No entry of the matrix couples two
/// even strips or two odd ones, and an odd strip reaches only one end of an even one. A forward sweep visits
/// all even strips in parallel, then all odd ones. A backward sweep visits them in reverse order.
struct SweepColouring {
  std::vector<Index> begin{0};  ///< strips + 1
  Index size() const { return static_cast<Index>(begin.size()) - 1; }
};

/// Nodes numbered for sweeps, with their neighbours in the matrix and the ordering graph.
struct NodeOrder {
  BlockRows nodes;
  SweepColouring strips;
  // Per node: the nodes coupled with it that a forward sweep meets first, ascending. Distant nodes often
  // share only one entry, that of both nodes' first rows. Such nodes are in `before_by_entry`, all others in
  // `before_by_block`.
  IndexLists before_by_block;
  IndexLists before_by_entry;
  IndexLists neighbours;  ///< in the ordering graph, else in the matrix; empty for shared nodes
  bool has_graph = false;
};

NodeOrder order_nodes(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context = {});

}  // namespace meshgraft
