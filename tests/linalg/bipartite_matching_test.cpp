#include "linalg/direct/bipartite_matching.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace meshgraft {
namespace {

using Edges = std::vector<std::pair<int, int>>;  // left, right

BipartiteGraph graph_of(int left, int right, const Edges& edges) {
  BipartiteGraph graph;
  graph.right_count = right;
  for (int vertex = 0; vertex < left; ++vertex) {
    for (const auto& [from, to] : edges)
      if (from == vertex) graph.right_end.push_back(to);
    graph.begin.push_back(static_cast<int>(graph.right_end.size()));
  }
  return graph;
}

struct NamedGraph {
  std::string name;
  int left = 0, right = 0;
  Edges edges;
};

Edges random_edges(int left, int right, int count, std::minstd_rand& generator) {
  Edges edges;
  for (int edge = 0; edge < count; ++edge)
    edges.emplace_back(generator() % static_cast<unsigned>(left), generator() % static_cast<unsigned>(right));
  return edges;
}

/// Returns graphs of many kinds: empty, stars, paths, complete ones, random ones of several densities.
std::vector<NamedGraph> graph_families() {
  std::vector<NamedGraph> graphs{{"nothing", 0, 0, {}}, {"no edge", 3, 2, {}}, {"no right vertex", 3, 0, {}}};
  NamedGraph star{"star", 1, 9, {}}, reversed{"reversed star", 9, 1, {}}, complete{"complete", 6, 4, {}},
      path{"path", 50, 50, {}}, twice{"edges twice", 3, 3, {{0, 1}, {0, 1}, {2, 1}, {1, 2}, {1, 2}}};
  for (int k = 0; k < 9; ++k) {
    star.edges.emplace_back(0, k);
    reversed.edges.emplace_back(k, 0);
  }
  for (int left = 0; left < 6; ++left)
    for (int right = 0; right < 4; ++right) complete.edges.emplace_back(left, right);
  // In this order of edges the greedy matching leaves both ends of the path free, so one long path augments it.
  for (int k = 0; k < 49; ++k) path.edges.emplace_back(k, k + 1);
  for (int k = 0; k < 50; ++k) path.edges.emplace_back(k, k);
  graphs.insert(graphs.end(), {star, reversed, complete, path, twice});
  std::minstd_rand generator(5);
  for (const auto& [left, right] : {std::pair{4, 4}, {7, 3}, {3, 8}, {60, 60}, {90, 40}, {40, 90}})
    for (const double degree : {0.5, 1.0, 2.0, 4.0})
      for (int sample = 0; sample < 4; ++sample)
        graphs.push_back(
            {"random", left, right, random_edges(left, right, static_cast<int>(degree * left), generator)});
  return graphs;
}

/// Counts the edges of a maximum matching by one augmenting path after another (Kuhn 1955).
class AugmentingPaths {
 public:
  explicit AugmentingPaths(const NamedGraph& graph) : graph_(graph), partner_(graph.right, -1) {}
  int size() {
    int matched = 0;
    for (int left = 0; left < graph_.left; ++left) {
      tried_.assign(static_cast<std::size_t>(graph_.right), false);
      matched += augment(left) ? 1 : 0;
    }
    return matched;
  }

 private:
  bool augment(int left) {
    for (const auto& [from, right] : graph_.edges) {
      if (from != left || tried_[right]) continue;
      tried_[right] = true;
      if (partner_[right] < 0 || augment(partner_[right])) {
        partner_[right] = left;
        return true;
      }
    }
    return false;
  }
  const NamedGraph& graph_;
  std::vector<int> partner_;
  std::vector<bool> tried_;
};

int matched_edges(const Matching& matching) {
  return static_cast<int>(
      std::count_if(matching.of_left.begin(), matching.of_left.end(), [](int right) { return right >= 0; }));
}

TEST(BipartiteMatching, JoinsVerticesByEdgesEachOnce) {
  for (const NamedGraph& family : graph_families()) {
    const Matching matching = maximum_matching(graph_of(family.left, family.right, family.edges));
    ASSERT_EQ(static_cast<int>(matching.of_left.size()), family.left) << family.name;
    ASSERT_EQ(static_cast<int>(matching.of_right.size()), family.right) << family.name;
    for (int left = 0; left < family.left; ++left) {
      const int right = matching.of_left[left];
      if (right < 0) continue;
      EXPECT_EQ(matching.of_right[right], left) << family.name;
      EXPECT_EQ(std::count(family.edges.begin(), family.edges.end(), std::pair(left, right)) > 0, true)
          << family.name;
    }
    EXPECT_EQ(std::count_if(matching.of_right.begin(), matching.of_right.end(), [](int l) { return l >= 0; }),
              matched_edges(matching))
        << family.name;
  }
}

TEST(BipartiteMatching, HasAsManyEdgesAsAugmentingPathsFind) {
  for (const NamedGraph& family : graph_families())
    EXPECT_EQ(matched_edges(maximum_matching(graph_of(family.left, family.right, family.edges))),
              AugmentingPaths(family).size())
        << family.name << ' ' << family.left << ' ' << family.edges.size();
}

VertexCover cover_of(const BipartiteGraph& graph) {
  return minimum_vertex_cover(graph, maximum_matching(graph));
}

TEST(VertexCover, TouchesEveryEdgeWithAsManyVerticesAsTheMatchingHasEdges) {
  for (const NamedGraph& family : graph_families()) {
    const BipartiteGraph graph = graph_of(family.left, family.right, family.edges);
    const Matching matching = maximum_matching(graph);
    const VertexCover cover = minimum_vertex_cover(graph, matching);
    for (const auto& [left, right] : family.edges) EXPECT_TRUE(cover.left[left] || cover.right[right]);
    const auto size = std::accumulate(cover.left.begin(), cover.left.end(), 0) +
                      std::accumulate(cover.right.begin(), cover.right.end(), 0);
    EXPECT_EQ(size, matched_edges(matching)) << family.name;
  }
}

TEST(VertexCover, IsTheSameInWhateverOrderEdgesAre) {
  std::minstd_rand generator(8);
  for (const NamedGraph& family : graph_families()) {
    const VertexCover cover = cover_of(graph_of(family.left, family.right, family.edges));
    Edges shuffled = family.edges;
    std::shuffle(shuffled.begin(), shuffled.end(), generator);
    const VertexCover again = cover_of(graph_of(family.left, family.right, shuffled));
    EXPECT_EQ(again.left, cover.left) << family.name;
    EXPECT_EQ(again.right, cover.right) << family.name;

    // Renumbering the vertices renumbers the cover alike.
    std::vector<int> number(static_cast<std::size_t>(family.left));
    std::iota(number.begin(), number.end(), 0);
    std::shuffle(number.begin(), number.end(), generator);
    for (auto& [left, right] : shuffled) left = number[left];
    const VertexCover renumbered = cover_of(graph_of(family.left, family.right, shuffled));
    for (int left = 0; left < family.left; ++left) EXPECT_EQ(renumbered.left[number[left]], cover.left[left]);
    EXPECT_EQ(renumbered.right, cover.right) << family.name;
  }
}

TEST(VertexCover, HasAllLeftVerticesThatAnySmallestOneHas) {
  for (const NamedGraph& family : graph_families()) {
    const int vertices = family.left + family.right;
    if (vertices > 12) continue;
    const VertexCover cover = cover_of(graph_of(family.left, family.right, family.edges));
    unsigned own = 0;
    for (int left = 0; left < family.left; ++left) own |= unsigned{cover.left[left]} << left;
    for (int right = 0; right < family.right; ++right)
      own |= unsigned{cover.right[right]} << (family.left + right);
    for (unsigned other = 0; other < 1U << vertices; ++other) {
      const bool covers = std::all_of(family.edges.begin(), family.edges.end(), [&](const auto& edge) {
        return (other >> edge.first & 1U) != 0 || (other >> (family.left + edge.second) & 1U) != 0;
      });
      if (!covers) continue;
      ASSERT_GE(std::popcount(other), std::popcount(own)) << family.name;
      if (std::popcount(other) > std::popcount(own)) continue;
      const unsigned left_of_other = other & ((1U << family.left) - 1);
      EXPECT_EQ(left_of_other & own, left_of_other) << family.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
