// Poses of large regions are solved on a proxy first. That saves steps and changes little.
#include <algorithm>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "deform/coarse_start.h"
#include "deform/deformer_impl.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;

std::vector<Scene> large_scenes() {
  std::vector<Scene> scenes;
  for (TestMesh& mesh : std::vector<TestMesh>{irregular_grid(260, 200), tube(150, 360)})
    scenes.push_back(make_scene(std::move(mesh)));
  return scenes;
}

Deformer set_up(const Scene& scene, const DeformerOptions& options = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, held_foot(scene), options};
}

/// Returns the positions that the region's own steps lead to, and counts these.
Points without_start(const Deformer& deformer, const std::vector<VertexConstraint>& constraints, int& steps) {
  const Deformer::Impl& d = deformer.impl();
  const RotationField::Result found = d.rotations->find(constraints, {});
  steps = found.iterations;
  Points positions(d.system->rest().rows(), 3);
  d.system->evaluate(constraints, found.problem, positions, nullptr, nullptr, {});
  return positions;
}

TEST(CoarseStart, SavesStepsAndChangesLittle) {
  for (const Scene& scene : large_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Deformer deformer = set_up(scene);
    const std::vector poses{pose_of(head_move(scene))};
    EvaluationReport report;
    const Points started = deformer.evaluate(poses, {}, &report);
    int steps = 0;
    const Points plain = without_start(deformer, deformer.constraints(poses), steps);
    EXPECT_LT(report.iterations, steps);
    EXPECT_LT(report.last_rotation_change, settled_change);
    const double motion = (plain - scene.mesh.positions).norm();
    EXPECT_LT((started - plain).norm(), 3e-3 * motion);
    EXPECT_GT((started - plain).norm(), 0);
  }
}

TEST(CoarseStart, GivesTheMapOfAnAffineMotion) {
  for (const Scene& scene : large_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, two_handles(scene));
    const Deformer::Impl& d = deformer.impl();
    ASSERT_NE(d.start, nullptr);
    const Affine3d map = about_middle(scene.mesh, linear_maps().back().second);
    const std::vector<VertexConstraint> constraints =
        deformer.constraints(std::vector{pose_of(map), pose_of(map)});
    const Columns maps = d.start->maps(constraints, d.system->patch(), {});
    ASSERT_EQ(maps.rows(), 3 * d.system->patch().size());
    double error = 0;
    for (Eigen::Index v = 0; 3 * v < maps.rows(); ++v)
      error =
          std::max(error, (maps.middleRows<3>(3 * v).transpose() + Eigen::Matrix3d::Identity() - map.linear())
                              .cwiseAbs()
                              .maxCoeff());
    EXPECT_LT(error, 1e-8);
  }
}

TEST(CoarseStart, LeavesTheResultToThePoseAlone) {
  const Scene scene = large_scenes().front();
  const Deformer deformer = set_up(scene), other = set_up(scene);
  const std::vector poses{pose_of(head_move(scene))};
  const Points expected = deformer.evaluate(poses, {.threads = 1});
  other.evaluate(std::vector{HandlePose{}});
  EXPECT_TRUE(other.evaluate(poses, {.threads = 2}) == expected);
  EXPECT_TRUE(other.evaluate(std::vector{HandlePose{}}) == scene.mesh.positions);
}

/// Returns edits of different kinds with the head as the handle, each with its name.
std::vector<std::pair<std::string, Region>> kinds_of_edits(const Scene& scene) {
  const Region plain = held_foot(scene);
  std::vector<std::pair<std::string, Region>> edits(3, {"positions only", plain});
  edits[0].second.handles[0].constrain_transform = false;
  edits[1].first = "transforms only";
  edits[1].second.handles[0].constrain_position = false;
  edits[2].first = "anchors";
  for (Index v = 0; v < static_cast<Index>(scene.mesh.positions.rows()); v += 997)
    edits[2].second.anchors.push_back({v, 0.1});
  return edits;
}

TEST(CoarseStart, ChangesLittleInEveryKindOfEdit) {
  const Scene scene = large_scenes().back();
  const TestMesh& mesh = scene.mesh;
  for (const auto& [name, region] : kinds_of_edits(scene)) {
    SCOPED_TRACE(name);
    std::vector<HandlePose> poses(region.handles.size());
    poses.back() = pose_of(head_move(scene));
    const Deformer started(mesh.positions, mesh.triangles, region);
    ASSERT_NE(started.impl().start, nullptr);
    const Deformer plain(mesh.positions, mesh.triangles, region, {.coarse_start = false});
    const Points expected = plain.evaluate(poses);
    const double motion = (expected - mesh.positions).norm();
    EXPECT_GT(motion, 0.1 * mesh.positions.norm());
    EXPECT_LT((started.evaluate(poses) - expected).norm(), 3e-3 * motion);
  }
}

// A proxy of a sheet that buckles may buckle elsewhere.
TEST(CoarseStart, IsLeftOutWhereItsProxyDoesNotSettle) {
  const TestMesh mesh = irregular_grid(260, 200);
  Region region;
  Handle disc = make_handle("disc", {});
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  const Eigen::RowVector3d middle = (low + high) / 2;
  const double width = (high - low).head<2>().minCoeff();
  for (Index v = 0; v < static_cast<Index>(mesh.positions.rows()); ++v) {
    region.vertices.push_back(v);
    const Eigen::RowVector2d from_middle = (mesh.positions.row(v) - middle).head<2>();
    if ((from_middle.cwiseAbs() - 0.48 * (high - low).head<2>()).maxCoeff() > 0)
      region.fixed.push_back(v);
    else if (from_middle.norm() < 0.1 * width)
      disc.vertices.push_back(v);
  }
  region.handles = {disc};
  const Deformer deformer(mesh.positions, mesh.triangles, region);
  const Deformer::Impl& d = deformer.impl();
  ASSERT_NE(d.start, nullptr);
  const Eigen::Translation3d pivot(middle.transpose());
  const Affine3d map = pivot * Eigen::Scaling(2.3) * pivot.inverse();
  const std::vector<VertexConstraint> constraints = deformer.constraints(std::vector{pose_of(map)});
  EXPECT_EQ(d.start->maps(constraints, d.system->patch(), {}).rows(), 0);
}

TEST(CoarseStart, ServesAnotherRegionOfTheSameMesh) {
  const Scene scene = large_scenes().front();
  const Region region = two_handles(scene);
  const Deformer first = set_up(scene), alone(scene.mesh.positions, scene.mesh.triangles, region);
  const Deformer second = first.with_region(region);
  ASSERT_NE(second.impl().start, nullptr);
  const std::vector poses{HandlePose{}, pose_of(head_move(scene))};
  EXPECT_LT(largest_distance(second.evaluate(poses), alone.evaluate(poses)), 1e-9);
}

TEST(CoarseStart, CanBeCancelled) {
  const Scene scene = large_scenes().front();
  const Deformer deformer = set_up(scene);
  const std::vector<VertexConstraint> constraints =
      deformer.constraints(std::vector{pose_of(head_move(scene))});
  std::stop_source stop;
  stop.request_stop();
  const Deformer::Impl& d = deformer.impl();
  EXPECT_THROW(d.start->maps(constraints, d.system->patch(), {.stop_token = stop.get_token()}), Error);
}

TEST(CoarseStart, IsMadeOnlyWhereItHelps) {
  const Scene large = large_scenes().front(), small = make_scene(irregular_grid(66, 44));
  const auto has_start = [](const Deformer& deformer) { return deformer.impl().start != nullptr; };
  EXPECT_TRUE(has_start(set_up(large)));
  EXPECT_FALSE(has_start(set_up(small)));
  EXPECT_FALSE(has_start(set_up(large, {.coarse_start = false})));
  Region symmetric = held_foot(large);
  symmetric.symmetric = true;
  EXPECT_FALSE(has_start(set_up(large).with_region(symmetric)));
  for (const DeformMethod method : {DeformMethod::ft05, DeformMethod::rotation_aware})
    EXPECT_FALSE(has_start(set_up(large, {.method = method}))) << to_string(method);
}

}  // namespace
}  // namespace meshgraft::test
