#include "merge/graft.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "merge/closed_curves.h"
#include "merge/graft_scenes.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

TEST(LoopRadius, IsTheRootMeanSquareFromTheCentre) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    std::vector<Index> loop;
    for (Index k = 0; k < curve.size(); ++k) loop.push_back(k);
    const double radius = loop_radius(curve.points, loop);
    for (const Eigen::Affine3d& map : test::similarities())
      EXPECT_NEAR(loop_radius(test::mapped(curve.points, map), loop),
                  std::cbrt(map.linear().determinant()) * radius, 1e-9 * radius * map.linear().norm())
          << curve.name;
  }
  EXPECT_NEAR(loop_radius(test::tube(12, 3).positions, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}), 0.4, 1e-12);
}

TEST(BeyondInfluenceRadius, CountsRingsOfEdges) {
  for (const test::GraftScene& scene : test::graft_scenes())
    for (const int rings : {0, 1, 3}) {
      const std::vector<Index> far =
          beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {.rings = rings}, 1);
      const std::vector<Index> near = grow_rings(scene.loops[0], rings, scene.rings);
      for (Index v = 0; v < scene.mesh.size(); ++v)
        EXPECT_NE(std::binary_search(far.begin(), far.end(), v),
                  std::binary_search(near.begin(), near.end(), v))
            << scene.mesh.name;
    }
}

TEST(BeyondInfluenceRadius, MeasuresLengthsAlongEdges) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto distance = edge_distance(scene.loops[0], scene.mesh.positions, scene.rings);
    const std::vector<Index> always_near = grow_rings(scene.loops[0], 2, scene.rings);
    std::size_t last = scene.mesh.positions.rows();
    for (const double length : {0.0, 0.3, 0.8, 100.0}) {
      const std::vector<Index> far =
          beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {.length = length}, 1);
      EXPECT_LE(far.size(), last);  // a longer reach leaves less
      last = far.size();
      for (Index v = 0; v < scene.mesh.size(); ++v) {
        const bool near =
            distance[v] <= length || std::binary_search(always_near.begin(), always_near.end(), v);
        EXPECT_NE(std::binary_search(far.begin(), far.end(), v), near) << scene.mesh.name;
      }
    }
    EXPECT_EQ(last, 0U);
  }
}

TEST(BeyondInfluenceRadius, ByDefaultLeavesTheFartherHalfAtLeast) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto distance = edge_distance(scene.loops[0], scene.mesh.positions, scene.rings);
    const double farthest = *std::max_element(distance.begin(), distance.end());
    const std::vector<Index> far =
        beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {}, 1000);
    const std::vector<Index> always_near = grow_rings(scene.loops[0], 2, scene.rings);
    for (Index v = 0; v < scene.mesh.size(); ++v) {
      if (distance[v] > farthest / 2 && !std::binary_search(always_near.begin(), always_near.end(), v)) {
        EXPECT_TRUE(std::binary_search(far.begin(), far.end(), v)) << scene.mesh.name;
      }
    }
  }
}

TEST(SolveGraft, ReproducesASimilarityOfTheLoop) {
  for (const test::GraftScene& scene : test::graft_scenes())
    for (const Eigen::Affine3d& map : test::similarities())
      for (const MergeShape shape : {MergeShape::similar, MergeShape::ft05}) {
        const std::vector<Index> far =
            beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {}, 1);
        const Graft graft =
            solve_graft(scene.mesh.positions, scene.mesh.triangles, test::constraints_of(scene, map), far,
                        scene.component, {.shape = shape}, {});
        const Points expected = test::mapped(scene.mesh.positions, map);
        EXPECT_LT(test::largest_distance(graft.positions, expected), 1e-6 * map.linear().norm())
            << scene.mesh.name;
      }
}

TEST(SolveGraft, MeetsItsConstraintsExactlyAndKeepsThePoseBeyondReach) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const std::vector<Index> far =
        beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {.rings = 3}, 1);
    Eigen::Affine3d map(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
    const auto constraints = test::constraints_of(scene, map);
    const Graft graft = solve_graft(scene.mesh.positions, scene.mesh.triangles, constraints, far,
                                    scene.component, {.pose = MergePose::keep}, {});
    for (const VertexConstraint& held : constraints)
      EXPECT_EQ(graft.positions.row(held.vertex), held.position->transpose()) << scene.mesh.name;
    for (const Index v : far) EXPECT_EQ(graft.positions.row(v), scene.mesh.positions.row(v)) << scene.mesh.name;
  }
}

TEST(SolveGraft, TheFarPartFollowsOneSimilarity) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const std::vector<Index> far =
        beyond_influence_radius(scene.mesh.positions, scene.rings, scene.loops, {.rings = 3}, 1);
    if (far.size() < 8) continue;
    auto constraints = test::constraints_of(scene, test::similarities()[0]);
    for (std::size_t k = 0; k < constraints.size(); ++k)
      *constraints[k].position *= 1 + 0.02 * std::sin(static_cast<double>(k));
    const Graft graft =
        solve_graft(scene.mesh.positions, scene.mesh.triangles, constraints, far, scene.component, {}, {});
    const test::AffineFit fit = test::fit_affine(scene.mesh.positions, graft.positions, far);
    EXPECT_LT(fit.misfit, 1e-6) << scene.mesh.name;
    const Eigen::Matrix3d square = fit.map.linear().transpose() * fit.map.linear();
    EXPECT_LT((square - square.trace() / 3 * Eigen::Matrix3d::Identity()).norm(), 1e-4 * square.trace())
        << scene.mesh.name;
  }
}

}  // namespace
}  // namespace meshgraft
