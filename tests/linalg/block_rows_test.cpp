#include "linalg/iterative/block_rows.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "node_systems.h"

namespace meshgraft {
namespace {

TEST(BlockRows, HaveEveryUnknownInOneRow) {
  for (const NodeSystem& system : node_systems()) {
    const BlockRows nodes = order_nodes(system.lower, system.graph()).nodes;
    ASSERT_EQ(static_cast<Eigen::Index>(nodes.row.size()), system.lower.rows()) << system.name;
    ASSERT_EQ(static_cast<Index>(nodes.unknown.size()), nodes.width * nodes.count) << system.name;
    for (std::size_t u = 0; u < nodes.row.size(); ++u)
      EXPECT_EQ(nodes.unknown[nodes.row[u]], static_cast<int>(u)) << system.name;
    const auto padding = std::count(nodes.unknown.begin(), nodes.unknown.end(), -1);
    EXPECT_EQ(nodes.unknown.size() - padding, nodes.row.size()) << system.name;
    for (Index node = 0; node < nodes.count; ++node)
      EXPECT_GE(nodes.unknown[nodes.width * node], 0) << system.name << ": only later rows pad";
  }
}

TEST(BlockRows, GatherUnknownsOfOneGroupInNodes) {
  for (const NodeSystem& system : node_systems()) {
    if (!system.has_graph) continue;
    const BlockRows nodes = order_nodes(system.lower, system.graph()).nodes;
    std::map<Index, Index> unknowns_of, nodes_of;
    for (const Index group : system.group)
      if (group >= 0) ++unknowns_of[group];
    for (Index node = 0; node < nodes.count; ++node) {
      const Index group = system.group[nodes.unknown[nodes.width * node]];
      EXPECT_EQ(nodes.shared[node] != 0, group < 0) << system.name;
      if (group >= 0) ++nodes_of[group];
      for (int row = nodes.width * node + 1; row < nodes.width * (node + 1); ++row) {
        if (nodes.unknown[row] < 0) continue;
        EXPECT_EQ(system.group[nodes.unknown[row]], group) << system.name;
        EXPECT_GE(group, 0) << system.name << ": an unknown without a group is alone";
      }
    }
    for (const auto& [group, unknowns] : unknowns_of)
      EXPECT_EQ(nodes_of[group], (unknowns + nodes.width - 1) / nodes.width)
          << system.name << ": as few as possible";
  }
}

TEST(BlockRows, HaveThePositionsOfTheirUnknowns) {
  for (const NodeSystem& system : node_systems()) {
    const BlockRows nodes = order_nodes(system.lower, system.graph()).nodes;
    ASSERT_EQ(nodes.positions.rows(), nodes.width * nodes.count) << system.name;
    for (Index row = 0; row < nodes.width * nodes.count; ++row) {
      const int unknown = nodes.unknown[nodes.unknown[row] >= 0 ? row : row - row % nodes.width];
      const Eigen::RowVector3d expected =
          system.has_graph ? Eigen::RowVector3d(system.positions.row(unknown)) : Eigen::RowVector3d::Zero();
      EXPECT_EQ(nodes.positions.row(row), expected) << system.name;
    }
  }
}

/// Calls `body(a, b)` for the nodes of every entry that couples two, with their rows.
template <class Body>
void for_each_coupling(const NormalMatrix& lower, const BlockRows& nodes, Body body) {
  for (Eigen::Index column = 0; column < lower.cols(); ++column)
    for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
      const int a = nodes.row[it.row()], b = nodes.row[column];
      if (a / nodes.width != b / nodes.width) body(a, b);
    }
}

std::vector<Index> strip_of_nodes(const NodeOrder& order) {
  std::vector<Index> strip(order.nodes.count, -1);
  for (Index s = 0; s < order.strips.size(); ++s)
    std::fill(strip.begin() + order.strips.begin[s], strip.begin() + order.strips.begin[s + 1], s);
  return strip;
}

TEST(SweepColouring, HasEveryNodeInOneStrip) {
  Index most = 0;
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder order = order_nodes(system.lower, system.graph());
    EXPECT_EQ(order.strips.begin.front(), 0) << system.name;
    EXPECT_EQ(order.strips.begin.back(), order.nodes.count) << system.name;
    EXPECT_TRUE(std::is_sorted(order.strips.begin.begin(), order.strips.begin.end(), std::less_equal<>()))
        << system.name;
    most = std::max(most, order.strips.size());
  }
  EXPECT_GE(most, 4) << "the families have systems of several strips";
}

// Strips of one parity are swept at the same time, so no entry couples two of them. The odd strips on both
// sides of an even one add to its nodes, so no node may be coupled with both.
TEST(SweepColouring, CouplesNoTwoStripsOfOneColourNorAnyNodeWithTwoOfTheOther) {
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder order = order_nodes(system.lower, system.graph());
    const std::vector<Index> strip = strip_of_nodes(order);
    std::vector<std::set<Index>> beside(order.nodes.count);
    for_each_coupling(system.lower, order.nodes, [&](int row, int other_row) {
      const Index a = row / order.nodes.width, b = other_row / order.nodes.width;
      if (strip[a] == strip[b]) return;
      EXPECT_NE(strip[a] % 2, strip[b] % 2) << system.name;
      beside[a].insert(strip[b]);
      beside[b].insert(strip[a]);
    });
    for (const std::set<Index>& strips : beside) EXPECT_LE(strips.size(), 1U) << system.name;
  }
}

std::pair<std::set<std::pair<Index, Index>>, std::set<std::pair<Index, Index>>> couplings_before(
    const NormalMatrix& lower, const NodeOrder& order) {
  const std::vector<Index> sequence = sweep_sequence(order);
  std::set<std::pair<Index, Index>> by_block, all;
  for_each_coupling(lower, order.nodes, [&](int row, int other_row) {
    const int width = order.nodes.width;
    std::pair<Index, Index> pair{row / width, other_row / width};
    if (sequence[pair.first] < sequence[pair.second]) std::swap(pair.first, pair.second);
    all.insert(pair);
    if (row % width != 0 || other_row % width != 0) by_block.insert(pair);
  });
  std::set<std::pair<Index, Index>> by_entry;
  std::set_difference(all.begin(), all.end(), by_block.begin(), by_block.end(),
                      std::inserter(by_entry, by_entry.end()));
  return {by_block, by_entry};
}

std::set<std::pair<Index, Index>> pairs_of(const IndexLists& lists) {
  std::set<std::pair<Index, Index>> pairs;
  for (Index node = 0; node < lists.size(); ++node)
    for (const Index other : lists[node]) pairs.emplace(node, other);
  return pairs;
}

TEST(NodeOrder, ListsTheCoupledNodesThatASweepMeetsFirst) {
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder order = order_nodes(system.lower, system.graph());
    const auto [by_block, by_entry] = couplings_before(system.lower, order);
    EXPECT_EQ(pairs_of(order.before_by_block), by_block) << system.name;
    EXPECT_EQ(pairs_of(order.before_by_entry), by_entry) << system.name;
    for (const IndexLists* lists : {&order.before_by_block, &order.before_by_entry}) {
      ASSERT_EQ(lists->size(), order.nodes.count) << system.name;
      for (Index node = 0; node < lists->size(); ++node) {
        const auto list = (*lists)[node];
        EXPECT_TRUE(std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) == list.end())
            << system.name;
      }
    }
  }
}

TEST(NodeOrder, HasTheNeighboursOfTheGraphOrElseOfTheMatrix) {
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder order = order_nodes(system.lower, system.graph());
    const BlockRows& nodes = order.nodes;
    std::set<std::pair<Index, Index>> expected;
    if (system.has_graph) {
      const auto group = [&](Index node) { return system.group[nodes.unknown[nodes.width * node]]; };
      const auto near = [&](Index a, Index b) {
        const auto beside = system.neighbours[a];
        return a == b || std::binary_search(beside.begin(), beside.end(), b);
      };
      for (Index a = 0; a < nodes.count; ++a)
        for (Index b = 0; b < nodes.count; ++b)
          if (a != b && group(a) >= 0 && group(b) >= 0 && near(group(a), group(b))) expected.emplace(a, b);
    } else {
      for_each_coupling(system.lower, nodes, [&](int a, int b) {
        if (nodes.shared[a] || nodes.shared[b]) return;  // one row per node
        expected.insert({{a, b}, {b, a}});
      });
    }
    EXPECT_EQ(order.has_graph, system.has_graph) << system.name;
    EXPECT_EQ(pairs_of(order.neighbours), expected) << system.name;
  }
}

TEST(NodeOrder, SharesHubsIfItKnowsNoGraph) {
  std::size_t hubs = 0;
  for (const NodeSystem& system : node_systems()) {
    if (system.has_graph || system.lower.rows() == 0) continue;
    const BlockRows nodes = order_nodes(system.lower, {}).nodes;
    std::vector<Index> coupled(nodes.count, 0);
    for_each_coupling(system.lower, nodes, [&](int a, int b) {
      ++coupled[a];
      ++coupled[b];
    });
    for (Index node = 0; node < nodes.count; ++node) {
      if (coupled[node] <= 64) {
        EXPECT_EQ(nodes.shared[node], 0) << system.name;
      }
      if (coupled[node] == nodes.count - 1 && nodes.count > 500) {
        EXPECT_EQ(nodes.shared[node], 1) << system.name;
      }
      hubs += nodes.shared[node];
    }
  }
  EXPECT_EQ(hubs, 1U) << "that of the wheel";
}

TEST(NodeOrder, IsTheSameForAnyNumberOfThreads) {
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder one = order_nodes(system.lower, system.graph(), with_threads(1));
    for (const int threads : {2, 3}) {
      const NodeOrder several = order_nodes(system.lower, system.graph(), with_threads(threads));
      EXPECT_EQ(several.nodes.row, one.nodes.row) << system.name;
      EXPECT_EQ(several.strips.begin, one.strips.begin) << system.name;
      EXPECT_EQ(several.before_by_block.values, one.before_by_block.values) << system.name;
      EXPECT_EQ(several.before_by_entry.values, one.before_by_entry.values) << system.name;
      EXPECT_EQ(several.neighbours.values, one.neighbours.values) << system.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
