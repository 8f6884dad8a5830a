#include "mesh/shortest_distances.h"

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// A walk along the edges of a mesh, whose distances are lengths.
struct EdgeGraph {
  Points positions;
  IndexLists rings;

  explicit EdgeGraph(const test::TestMesh& mesh)
      : positions(mesh.positions), rings(vertex_rings(mesh.size(), mesh.triangles)) {}
  double length(Index v, Index w) const { return (positions.row(v) - positions.row(w)).norm(); }
  auto visit() const {
    return [this](Index v, double reached, const auto& offer) {
      for (const Index w : rings[v]) offer(w, reached + length(v, w));
      return true;
    };
  }
};

TEST(ShortestDistances, CannotBeShortenedByAnyEdge) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const EdgeGraph graph(mesh);
    const std::vector<Index> seeds{mesh.triangles(0, 0), mesh.triangles(0, 1), mesh.triangles(0, 0)};
    std::vector<double> distance(mesh.size(), unreached);
    shortest_distances(seeds, distance, graph.visit());
    for (Index v = 0; v < mesh.size(); ++v) {
      double by_neighbour = unreached;
      for (const Index w : graph.rings[v])
        by_neighbour = std::min(by_neighbour, distance[w] + graph.length(v, w));
      const bool seed = v == seeds[0] || v == seeds[1];
      EXPECT_EQ(distance[v], seed ? 0 : by_neighbour);
    }
  }
}

TEST(ShortestDistances, FollowWhenSeedsAreAdded) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const EdgeGraph graph(mesh);
    const std::vector<Index> seeds{mesh.triangles(0, 0), mesh.triangles(mesh.triangles.rows() - 1, 1)};
    std::vector<double> together(mesh.size(), unreached), in_turn = together;
    SparseDistances sparse;
    shortest_distances(seeds, together, graph.visit());
    shortest_distances(seeds, sparse, graph.visit());
    for (const Index seed : seeds) shortest_distances(std::vector<Index>{seed}, in_turn, graph.visit());
    EXPECT_EQ(in_turn, together);
    for (Index v = 0; v < mesh.size(); ++v) EXPECT_EQ(sparse[v], together[v]);
  }
}

TEST(ShortestDistances, VisitTheNearestFirstAndEndWhenAsked) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const EdgeGraph graph(mesh);
    std::vector<double> distance(mesh.size(), unreached);
    std::vector<double> visited;
    shortest_distances(std::vector<Index>{mesh.triangles(0, 0)}, distance,
                       [&](Index v, double reached, const auto& offer) {
                         visited.push_back(reached);
                         graph.visit()(v, reached, offer);
                         return visited.size() < 3;
                       });
    EXPECT_EQ(visited.size(), 3);
    EXPECT_TRUE(std::ranges::is_sorted(visited));
  }
}

}  // namespace
}  // namespace meshgraft
