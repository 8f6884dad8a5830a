#include "linalg/iterative/aggregation.h"

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "matrix_families.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A graph of nodes. Those left out have no neighbours.
struct NodeGraph {
  std::string name;
  IndexLists neighbours;
  Flags left_out;
};

IndexLists without(const IndexLists& neighbours, const Flags& left_out) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index node = 0; node < neighbours.size(); ++node)
    for (const Index other : neighbours[node])
      if (!left_out[node] && !left_out[other]) edges.emplace_back(node, other);
  return neighbours_of(neighbours.size(), edges);
}

/// Returns the graphs of meshes, a star, a path, random ones and none, each also with some nodes left out.
std::vector<NodeGraph> node_graphs() {
  std::vector<NodeGraph> graphs;
  const auto add = [&](const std::string& name, const IndexLists& neighbours) {
    Flags left_out(neighbours.size(), 0);
    graphs.push_back({name, neighbours, left_out});
    for (std::size_t node = 3; node < left_out.size(); node += 7) left_out[node] = 1;
    graphs.push_back({name + " with some left out", without(neighbours, left_out), left_out});
  };
  for (const test::TestMesh& mesh : test::mesh_families())
    add(mesh.name, vertex_rings(mesh.size(), mesh.triangles));
  std::vector<std::pair<Index, Index>> star, path;
  for (Index node = 1; node < 400; ++node) {
    star.emplace_back(0, node);
    path.emplace_back(node - 1, node);
  }
  add("star", neighbours_of(400, star));
  add("path", neighbours_of(400, path));
  add("nothing", {});
  std::minstd_rand generator(2);
  for (const unsigned count : {50U, 300U, 900U}) {
    std::vector<std::pair<Index, Index>> edges;
    for (unsigned edge = 0; edge < count; ++edge) edges.emplace_back(generator() % 300, generator() % 300);
    add("random", neighbours_of(300, edges));
  }
  return graphs;
}

/// Returns the distances in edges from a node, among the nodes that `may` accepts; -1 beyond.
template <class May>
std::vector<int> edges_from(Index start, const IndexLists& neighbours, May may) {
  std::vector<int> distance(neighbours.size(), -1);
  std::vector<Index> queue{start};
  distance[start] = 0;
  for (std::size_t k = 0; k < queue.size(); ++k)
    for (const Index other : neighbours[queue[k]])
      if (distance[other] < 0 && may(other)) {
        distance[other] = distance[queue[k]] + 1;
        queue.push_back(other);
      }
  return distance;
}

std::vector<std::vector<Index>> members_of(const Aggregates& aggregates) {
  std::vector<std::vector<Index>> members(aggregates.count);
  for (std::size_t node = 0; node < aggregates.of_node.size(); ++node)
    if (aggregates.of_node[node] >= 0) members[aggregates.of_node[node]].push_back(static_cast<Index>(node));
  return members;
}

TEST(Aggregation, HasEveryNodeInOneAggregateUnlessItIsLeftOut) {
  for (const NodeGraph& graph : node_graphs())
    for (const int radius : {1, 2, 3}) {
      const Aggregates aggregates = aggregate(graph.neighbours, graph.left_out, radius);
      ASSERT_EQ(aggregates.of_node.size(), graph.left_out.size()) << graph.name;
      for (std::size_t node = 0; node < graph.left_out.size(); ++node) {
        EXPECT_EQ(aggregates.of_node[node] < 0, graph.left_out[node] != 0) << graph.name;
        EXPECT_LT(aggregates.of_node[node], aggregates.count) << graph.name;
      }
      for (const std::vector<Index>& members : members_of(aggregates))
        EXPECT_FALSE(members.empty()) << graph.name;
    }
}

TEST(Aggregation, HasConnectedAggregates) {
  for (const NodeGraph& graph : node_graphs())
    for (const int radius : {1, 2, 3}) {
      const Aggregates aggregates = aggregate(graph.neighbours, graph.left_out, radius);
      for (const std::vector<Index>& members : members_of(aggregates)) {
        const Index own = aggregates.of_node[members.front()];
        const std::vector<int> distance = edges_from(
            members.front(), graph.neighbours, [&](Index node) { return aggregates.of_node[node] == own; });
        EXPECT_TRUE(std::all_of(members.begin(), members.end(), [&](Index node) {
          return distance[node] >= 0;
        })) << graph.name;
      }
    }
}

// An aggregate has a centre whose ball is its own, and no member is farther from it than two radii. Only a
// connected component without room for a ball is divided otherwise.
TEST(Aggregation, HasABallInEachAggregateAndNoMemberFarFromIt) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
    std::size_t largest_ring = 0;
    for (Index v = 0; v < mesh.size(); ++v) largest_ring = std::max(largest_ring, rings[v].size());
    if (largest_ring > 12) continue;  // balls of more than 200 nodes are none
    for (const int radius : {1, 2}) {
      const Aggregates aggregates = aggregate(rings, Flags(mesh.size(), 0), radius);
      for (const std::vector<Index>& members : members_of(aggregates)) {
        const Index own = aggregates.of_node[members.front()];
        EXPECT_TRUE(std::any_of(members.begin(), members.end(), [&](Index centre) {
          const std::vector<int> distance = edges_from(centre, rings, [](Index) { return true; });
          for (Index node = 0; node < mesh.size(); ++node) {
            const bool member = aggregates.of_node[node] == own;
            if (!member && distance[node] >= 0 && distance[node] <= radius) return false;
            if (member && distance[node] > 2 * radius) return false;
          }
          return true;
        })) << mesh.name;
      }
    }
  }
}

// A node with more than 200 neighbours has no ball, and its neighbours' balls are none either.
TEST(Aggregation, DividesWhatHasNoBallIntoGroupsOfManyNodes) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index a = 0; a < 900; ++a)
    for (Index b = a + 1; b < std::min(900, a + 230); ++b) edges.emplace_back(a, b);
  const Aggregates aggregates = aggregate(neighbours_of(900, edges), Flags(900, 0), 1);
  for (const std::vector<Index>& members : members_of(aggregates)) EXPECT_LT(members.size(), 50U + 460U);
}

TEST(Blending, HasWeightsThatSumToOneOverFewDistinctAggregates) {
  for (const NodeGraph& graph : node_graphs()) {
    const Aggregates aggregates = aggregate(graph.neighbours, graph.left_out, 2);
    for (const int passes : {0, 1, 4}) {
      const Blending blending = blend(graph.neighbours, aggregates, passes);
      ASSERT_EQ(blending.aggregates.size(), graph.neighbours.size()) << graph.name;
      ASSERT_EQ(blending.weight.size(), blending.aggregates.values.size()) << graph.name;
      for (Index node = 0; node < graph.neighbours.size(); ++node) {
        const auto of_node = blending.aggregates[node];
        EXPECT_EQ(of_node.empty(), graph.left_out[node] != 0) << graph.name;
        EXPECT_LE(of_node.size(), 8U) << graph.name;
        EXPECT_EQ(std::set<Index>(of_node.begin(), of_node.end()).size(), of_node.size()) << graph.name;
        double sum = 0;
        for (std::size_t k = 0; k < of_node.size(); ++k) {
          const double weight = blending.weight[blending.aggregates.offsets[node] + k];
          EXPECT_GE(weight, 0.05 - 1e-12) << graph.name;
          sum += weight;
        }
        if (!of_node.empty()) {
          EXPECT_NEAR(sum, 1, 1e-12) << graph.name;
        }
      }
    }
  }
}

TEST(Blending, OfNoPassIsTheAggregateItself) {
  for (const NodeGraph& graph : node_graphs()) {
    const Aggregates aggregates = aggregate(graph.neighbours, graph.left_out, 2);
    const Blending blending = blend(graph.neighbours, aggregates, 0);
    for (Index node = 0; node < graph.neighbours.size(); ++node)
      for (const Index a : blending.aggregates[node]) EXPECT_EQ(a, aggregates.of_node[node]) << graph.name;
  }
}

TEST(Blending, ReachesAsManyEdgesAsThereArePasses) {
  for (const NodeGraph& graph : node_graphs()) {
    const Aggregates aggregates = aggregate(graph.neighbours, graph.left_out, 2);
    const int passes = 2;
    const Blending blending = blend(graph.neighbours, aggregates, passes);
    for (Index node = 0; node < graph.neighbours.size(); node += 5) {
      if (graph.left_out[node]) continue;
      const std::vector<int> distance = edges_from(node, graph.neighbours, [](Index) { return true; });
      std::set<Index> near;
      for (Index other = 0; other < graph.neighbours.size(); ++other)
        if (distance[other] >= 0 && distance[other] <= passes) near.insert(aggregates.of_node[other]);
      const auto of_node = blending.aggregates[node];
      EXPECT_TRUE(std::all_of(of_node.begin(), of_node.end(), [&](Index a) { return near.contains(a); }))
          << graph.name;
      if (near.size() == 1) {
        EXPECT_EQ(blending.weight[blending.aggregates.offsets[node]], 1) << graph.name;
      }
    }
  }
}

TEST(Blending, HasTheSameBytesForAnyNumberOfThreads) {
  const IndexLists grid = grid_neighbours(90, 80);  // several blocks of nodes
  const Aggregates aggregates = aggregate(grid, Flags(grid.size(), 0), 2);
  const Blending one = blend(grid, aggregates, 4, with_threads(1));
  for (const int threads : {2, 3}) {
    const Blending several = blend(grid, aggregates, 4, with_threads(threads));
    EXPECT_EQ(several.aggregates.offsets, one.aggregates.offsets);
    EXPECT_EQ(several.aggregates.values, one.aggregates.values);
    EXPECT_EQ(several.weight, one.weight);
  }
}

}  // namespace
}  // namespace meshgraft
