// A seam is watertight, and every vertex has its image.

#include <set>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/topology.h>

#include "merge/cut_halves.h"
#include "merge/seam.h"
#include "merge/seam_grafts.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

TEST(Seam, IsWatertightAndOfThePredictedTopology) {
  for (const Graft& graft : grafts()) {
    for (const StripMethod strip : {StripMethod::optimal, StripMethod::greedy}) {
      SCOPED_TRACE(graft.name);
      ASSERT_FALSE(graft.pairs.empty());
      const SeamResult result = make_seam(graft.target, graft.source, graft.pairs, {.strip = strip});
      const TopologySummary topology = summarise_topology(result.mesh);
      EXPECT_TRUE(topology.manifold);
      EXPECT_TRUE(topology.oriented);
      EXPECT_EQ(topology.closed, graft.closed);
      EXPECT_EQ(topology.components, 1);
      EXPECT_EQ(topology.isolated_vertices, 0);
      EXPECT_EQ(topology.euler_characteristic, graft.euler_characteristic);
      EXPECT_EQ(result.report.euler_characteristic, graft.euler_characteristic);
      EXPECT_EQ(result.report.expected_euler_characteristic, graft.euler_characteristic);
      EXPECT_TRUE(result.report.manifold && result.report.oriented);
      EXPECT_EQ(result.report.closed, graft.closed);
    }
  }
}

TEST(Seam, MapsEveryVertex) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    const std::set<Index> band(result.band.begin(), result.band.end());
    std::set<Index> loops, reached;
    for (const LoopPair& pair : graft.pairs) loops.insert(pair.target.begin(), pair.target.end());
    ASSERT_EQ(result.target.new_index.size(), graft.target.vertex_count());
    ASSERT_EQ(result.source.new_index.size(), graft.source.vertex_count());
    Index last = -1;
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index now = result.target.new_index[v];
      EXPECT_EQ(now < 0, loops.contains(v));
      if (now < 0) continue;
      EXPECT_GT(now, last);
      last = now;
      reached.insert(now);
      if (!band.contains(now)) {
        EXPECT_EQ(result.mesh.positions.row(now), graft.target.positions.row(v));
      }
    }
    for (Index v = 0; v < graft.source.vertex_count(); ++v) {
      const Index now = result.source.new_index[v];
      EXPECT_GT(now, last);
      last = now;
      reached.insert(now);
      if (!band.contains(now)) {
        EXPECT_EQ(result.mesh.positions.row(now), graft.source.positions.row(v));
      }
    }
    EXPECT_EQ(last, result.mesh.vertex_count() - 1);
    EXPECT_LE(reached.size(), result.mesh.vertex_count());  // refining the ring adds vertices
  }
}

TEST(Seam, VisitsAllVerticesOfBothSides) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult result = make_seam(graft.target, graft.source, graft.pairs);
    std::set<Index> visited;
    for (const Index f : result.new_faces) {
      visited.insert(result.mesh.faces[f].begin(), result.mesh.faces[f].end());
      EXPECT_EQ(result.mesh.faces[f].size(), 3);
    }
    for (const LoopPair& pair : graft.pairs) {
      for (const Index v : pair.source) EXPECT_TRUE(visited.contains(result.source.new_index[v]));
    }
    EXPECT_EQ(result.report.new_faces, result.new_faces.size());
    // Each strip triangle has exactly one edge of a loop, so there are as many as vertices on the loops.
    EXPECT_EQ(visited.size(), result.new_faces.size());
  }
}

// With few rows of faces between two loops, refining keeps the loops' rings apart.
TEST(Seam, HalvesRingsThatWouldMeet) {
  for (const bool triangles : {false, true}) {
    for (const int rows : {1, 2, 3}) {
      SCOPED_TRACE(rows);
      const Mesh whole = shapes::tube(20, rows + 8, triangles);
      const Mesh target = faces_where(whole, [&](Index f) {
        const Index row = f / (triangles ? 40 : 20);
        return row >= 4 && row < 4 + rows;
      });
      const Mesh source = faces_where(whole, [&](Index f) {
        const Index row = f / (triangles ? 40 : 20);
        return row < 4 || row >= 4 + rows;
      });
      const std::vector<LoopPair> pairs = coinciding_loops(target, source);
      ASSERT_EQ(pairs.size(), 2);
      const SeamResult both = make_seam(target, source, pairs);
      EXPECT_TRUE(both.report.manifold && both.report.oriented);
      EXPECT_EQ(both.report.euler_characteristic, 0);
      EXPECT_EQ(summarise_topology(both.mesh).boundary_loops, 2);
      // A single pair must leave the target's other loop alone.
      const SeamResult one = make_seam(target, source, std::span(pairs).first(1));
      EXPECT_EQ(summarise_topology(one.mesh).boundary_loops, 4);
      EXPECT_TRUE(one.report.manifold && one.report.oriented);
    }
  }
}

TEST(Seam, DoesNotDependOnTheOrderOfPairsTheStartsOrTheThreads) {
  for (const Graft& graft : grafts()) {
    SCOPED_TRACE(graft.name);
    const SeamResult one = make_seam(graft.target, graft.source, graft.pairs);
    std::vector<LoopPair> pairs(graft.pairs.rbegin(), graft.pairs.rend());
    for (LoopPair& pair : pairs) {
      std::rotate(pair.source.begin(), pair.source.begin() + 5, pair.source.end());
      std::rotate(pair.target.begin(), pair.target.begin() + 3, pair.target.end());
    }
    const SeamResult other = make_seam(graft.target, graft.source, pairs, {}, shapes::with_threads(3));
    EXPECT_TRUE(same_positions(one.mesh.positions, other.mesh.positions));
    EXPECT_EQ(one.mesh.faces, other.mesh.faces);
  }
}

}  // namespace
}  // namespace meshgraft::test
