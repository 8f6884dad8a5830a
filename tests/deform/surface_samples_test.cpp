#include "deform/reduced/surface_samples.h"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

/// A family with every other vertex a candidate and its first tenth seeds.
struct SampleScene {
  test::TestMesh mesh;
  IndexLists rings;
  Flags seeds, candidates;

  explicit SampleScene(test::TestMesh family)
      : mesh(std::move(family)), rings(vertex_rings(mesh.size(), mesh.triangles)) {
    for (Index v = 0; v < mesh.size(); ++v) {
      seeds.push_back(v < mesh.size() / 10);
      candidates.push_back(v % 2 == 1);
    }
  }
  std::vector<double> distance_from(const std::vector<Index>& sources) const {
    std::vector<Index> all = sources;
    for (Index v = 0; v < mesh.size(); ++v)
      if (seeds[v]) all.push_back(v);
    return edge_distance(all, mesh.positions, rings, {.limit = everywhere});
  }
  /// Returns the same in units that triple from the seeds to the vertex farthest from them.
  std::vector<double> graded_distance_from(const std::vector<Index>& sources) const {
    std::vector<double> unit = distance_from({});
    double farthest = 0;
    for (const double distance : unit)
      if (distance < everywhere) farthest = std::max(farthest, distance);
    for (double& u : unit) u = 1 + 2 * (farthest > 0 ? std::min(u / farthest, 1.0) : 0);
    std::vector<double> distance(unit.size(), everywhere);
    for (const Index v : sources) distance[v] = 0;
    for (Index v = 0; v < mesh.size(); ++v)
      if (seeds[v]) distance[v] = 0;
    for (bool changed = true; changed;) {  // Bellman and Ford
      changed = false;
      for (Index v = 0; v < mesh.size(); ++v)
        for (const Index w : rings[v]) {
          const double through =
              distance[w] + 2 * (mesh.positions.row(v) - mesh.positions.row(w)).norm() / (unit[v] + unit[w]);
          if (through < distance[v]) {
            distance[v] = through;
            changed = true;
          }
        }
    }
    return distance;
  }
};

TEST(SurfaceSamples, EachIsTheCandidateFarthestFromThoseBefore) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const SampleScene scene(family);
    const std::vector<Index> samples =
        farthest_vertices(scene.mesh.positions, scene.rings, scene.seeds, scene.candidates, 12);
    std::vector<Index> before;
    double last = everywhere;
    for (const Index s : samples) {
      ASSERT_TRUE(scene.candidates[s]);
      const std::vector<double> distance = scene.graded_distance_from(before);
      double farthest = 0;
      for (Index v = 0; v < scene.mesh.size(); ++v)
        if (scene.candidates[v]) farthest = std::max(farthest, distance[v]);
      EXPECT_NEAR(std::min(distance[s], 1e9), std::min(farthest, 1e9), 1e-12);
      EXPECT_LE(distance[s], last + 1e-12);  // so samples spread ever more densely
      last = distance[s];
      before.push_back(s);
    }
    EXPECT_EQ(std::set<Index>(samples.begin(), samples.end()).size(), samples.size());
  }
}

TEST(SurfaceSamples, EveryComponentGetsOne) {
  const test::TestMesh one = test::icosphere(1);
  const Index n = one.size();
  Points points(3 * n, 3);
  points << one.positions, one.positions.array() + 5, one.positions.array() - 5;
  Triangles triangles(3 * one.triangles.rows(), 3);
  triangles << one.triangles, one.triangles.array() + n, one.triangles.array() + 2 * n;
  const IndexLists rings = vertex_rings(3 * n, triangles);
  Flags seeds(static_cast<std::size_t>(3 * n), 0), candidates(seeds.size(), 1);
  seeds[0] = 1;
  const std::vector<Index> samples = farthest_vertices(points, rings, seeds, candidates, 1);
  EXPECT_EQ(samples.size(), 2U);  // more than asked for: the seed serves its own component
  std::set<Index> components;
  for (const Index s : samples) components.insert(s / n);
  EXPECT_EQ(components, (std::set<Index>{1, 2}));
}

TEST(SurfaceSamples, EndWhereNoCandidateIsLeft) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const SampleScene scene(family);
    const std::vector<Index> samples =
        farthest_vertices(scene.mesh.positions, scene.rings, scene.seeds, scene.candidates, 10 * family.size());
    Index wanted = 0;
    for (Index v = 0; v < family.size(); ++v) wanted += scene.candidates[v] && !scene.seeds[v];
    EXPECT_EQ(static_cast<Index>(samples.size()), wanted);
    const Flags none(scene.seeds.size(), 0);
    EXPECT_TRUE(farthest_vertices(scene.mesh.positions, scene.rings, scene.seeds, none, 5).empty());
  }
}

TEST(SurfaceSamples, EveryVertexBelongsToItsNearestSample) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
    const std::vector<Index> samples{mesh.size() / 2, 0, mesh.size() - 1};
    const std::vector<Index> nearest = nearest_sample(mesh.positions, rings, samples);
    std::vector<std::vector<double>> distance;
    for (const Index s : samples)
      distance.push_back(edge_distance(std::vector{s}, mesh.positions, rings, {.limit = everywhere}));
    for (Index v = 0; v < mesh.size(); ++v) {
      double least = everywhere;
      for (const auto& from : distance) least = std::min(least, from[v]);
      if (least == everywhere) {
        EXPECT_EQ(nearest[v], -1);
      } else {
        ASSERT_GE(nearest[v], 0);
        EXPECT_NEAR(distance[nearest[v]][v], least, 1e-12 * (1 + least));
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
