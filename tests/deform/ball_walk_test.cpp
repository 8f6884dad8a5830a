#include "deform/setup/ball_walk.h"

#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// Returns the visits of a walk: vertex → squared distance. Each vertex must be visited once.
std::map<Index, double> visits(BallWalk& walk, Index start, double radius) {
  std::map<Index, double> met;
  walk.from(start, radius, [&](Index v, double squared) {
    EXPECT_TRUE(met.emplace(v, squared).second) << "visited twice: " << v;
  });
  return met;
}

TEST(BallWalk, VisitsWhatIsConnectedWithinTheBall) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
    BallWalk walk(mesh.positions, rings);
    for (Index start = 0; start < mesh.size(); start += 1 + mesh.size() / 7)
      for (const double share : {0.05, 0.3, 2.0}) {
        const double radius = share * mesh.box_diagonal();
        const std::map<Index, double> met = visits(walk, start, radius);
        EXPECT_EQ(met.at(start), 0);
        for (const auto& [v, squared] : met) {
          EXPECT_EQ(squared, (mesh.positions.row(v) - mesh.positions.row(start)).squaredNorm());
          if (v != start) {
            EXPECT_LT(squared, radius * radius);
          }
          // No neighbour within the ball is left out, so the visited part ends only at the ball's boundary.
          for (const Index w : rings[v]) {
            if ((mesh.positions.row(w) - mesh.positions.row(start)).squaredNorm() < radius * radius) {
              EXPECT_TRUE(met.contains(w));
            }
          }
        }
        // Each visited vertex is connected with the start through visited ones: it has a visited neighbour.
        for (const auto& [v, squared] : met) {
          bool linked = v == start;
          for (const Index w : rings[v]) linked = linked || met.contains(w);
          EXPECT_TRUE(linked);
        }
      }
  }
}

TEST(BallWalk, StaysOnItsSheet) {
  const test::TestMesh sheet = test::flat_sheet(8, 8);
  const Index n = sheet.size();
  Points points(2 * n, 3);
  points << sheet.positions, sheet.positions;
  points.bottomRows(n).col(2).array() += 1e-3;
  Triangles triangles(2 * sheet.triangles.rows(), 3);
  triangles << sheet.triangles, sheet.triangles.array() + n;
  const IndexLists rings = vertex_rings(2 * n, triangles);
  BallWalk walk(points, rings);
  const auto low = visits(walk, 40, 1.0), high = visits(walk, 40 + n, 1.0);
  EXPECT_LT(low.rbegin()->first, n);
  EXPECT_GE(high.begin()->first, n);
  EXPECT_EQ(low.size(), high.size());
}

TEST(BallWalk, WithoutARadiusVisitsItsStartAlone) {
  const test::TestMesh mesh = test::with_isolated_vertices(test::grid(4, 4));
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  BallWalk walk(mesh.positions, rings);
  for (Index v = 0; v < mesh.size(); ++v) {
    EXPECT_EQ(visits(walk, v, 0), (std::map<Index, double>{{v, 0.0}}));
    if (rings[v].empty()) {
      EXPECT_EQ(visits(walk, v, 1e9).size(), 1U);
    }
  }
}

}  // namespace
}  // namespace meshgraft
