#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Nodes in compact groups of some two rings' size, numbered along the nodes.
struct Aggregates {
  Index count = 0;
  std::vector<Index> of_node;  ///< -1 for nodes that are left out
};

/// Takes, along the nodes, every one whose ball of `radius` edges is untouched as the middle of an aggregate;
/// nodes in between join the nearest one. `left_out` flags nodes that take no part.
Aggregates aggregate(const IndexLists& neighbours, std::span<const std::uint8_t> left_out, int radius,
                     const Context& context = {});

/// How much each node belongs to each aggregate: weights that add up to one and fade from aggregate to
/// aggregate over some rings, so that what is blended with them is smooth.
struct Blending {
  IndexLists aggregates;       ///< of each node; none for nodes that are left out
  std::vector<double> weight;  ///< beside their values
};

/// Averages membership over each node's ring `passes` times, dropping what has become slight.
Blending blend(const IndexLists& neighbours, const Aggregates& aggregates, int passes,
               const Context& context = {});

}  // namespace meshgraft
