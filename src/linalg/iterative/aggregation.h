#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Aggregates: compact groups of nodes with a radius of about two rings, numbered in the order of their
/// nodes.
struct Aggregates {
  Index count = 0;
  std::vector<Index> of_node;  ///< -1 for excluded nodes
};

/// Makes aggregates of nodes. In the order of the nodes, a node is the centre of an aggregate if the ball of
/// `radius` edges around it is still free. Nodes in between join the nearest aggregate. `left_out` flags
/// excluded nodes.
Aggregates aggregate(const IndexLists& neighbours, std::span<const std::uint8_t> left_out, int radius,
                     const Context& context = {});

/// The weights by which each node belongs to aggregates. They sum to one and fade over some rings from
/// aggregate to aggregate, so that a blend with them is smooth.
struct Blending {
  IndexLists aggregates;       ///< per node; empty for excluded nodes
  std::vector<double> weight;  ///< parallel to the values of `aggregates`
};

/// Averages the membership over each node's ring `passes` times, and drops weights that become small.
Blending blend(const IndexLists& neighbours, const Aggregates& aggregates, int passes,
               const Context& context = {});

}  // namespace meshgraft
