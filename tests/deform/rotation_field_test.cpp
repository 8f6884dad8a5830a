#include "deform/solve/rotation_field.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/rotating_methods.h"
#include "deform/solve/corotation.h"
#include "deform/solve/rotations.h"
#include "deform/system_scene.h"
#include "linalg/sparse.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::SystemScene;

constexpr DeformerOptions corotational;
const DeformerOptions blend_only{.method = DeformMethod::rotation_aware};

/// Returns the map of a field at a vertex of the patch.
Matrix3d map_at(const Columns& field, Index v) {
  return field.middleRows<3>(3 * v).transpose() + Matrix3d::Identity();
}

/// Returns the largest difference of a field from one map.
double deviation_from(const Columns& field, const Matrix3d& map) {
  const auto n = static_cast<Index>(field.rows() / 3);
  return (field - test::constant_maps(n, map)).cwiseAbs().maxCoeff();
}

/// Poses that leave the foot at rest and move the head.
std::vector<HandlePose> head_moved(const test::Scene& scene) {
  return {HandlePose{}, test::pose_of(test::head_move(scene))};
}

/// Returns constraints that follow a motion after their own: positions u to Q u, transforms W to Q W.
std::vector<VertexConstraint> moved_afterwards(std::vector<VertexConstraint> constraints,
                                               const Eigen::Affine3d& motion) {
  for (VertexConstraint& constraint : constraints) {
    if (constraint.position) constraint.position = motion * *constraint.position;
    if (constraint.transform) constraint.transform = motion.linear() * *constraint.transform;
  }
  return constraints;
}

Eigen::Affine3d any_motion() {
  return Eigen::Translation3d(0.3, -1, 0.5) * Eigen::AngleAxisd(2.2, Vector3d(1, -2, 3).normalized());
}

TEST(RotationField, IsTheIdentityAtRest) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const DeformerOptions& options : {corotational, blend_only}) {
      SCOPED_TRACE(mesh.name);
      const SystemScene scene(mesh, test::held_foot(test::make_scene(mesh)), options);
      const auto found = scene.rotations->find(scene.all_moved(Eigen::Affine3d::Identity()), {});
      EXPECT_FALSE(found.linear);
      EXPECT_LT(deviation_from(found.problem.field.maps, Matrix3d::Identity()), 1e-12);
      EXPECT_LE(found.iterations, 1);
      EXPECT_LT(found.change, 1e-12);
    }
}

TEST(RotationField, FollowsOneMapOfAllHandles) {
  for (const test::TestMesh& mesh : test::small_families())
    for (auto [name, linear] : test::linear_maps()) {
      if (name == "reflection") name = "similarity", linear = 1.7 * any_motion().linear();
      SCOPED_TRACE(mesh.name + ", " + name);
      const SystemScene scene(mesh, test::two_handles(test::make_scene(mesh)));
      const auto found = scene.rotations->find(scene.all_moved(test::about_middle(mesh, linear)), {});
      EXPECT_FALSE(found.linear);
      EXPECT_EQ(found.iterations, 1) << "the first step has nothing to change";
      EXPECT_LT(found.change, 1e-8);
      EXPECT_LT(deviation_from(found.problem.field.maps, linear), 1e-8);
      EXPECT_TRUE(found.problem.field.smooth);
    }
}

TEST(RotationField, FitsOneMapToPositionsWithoutTransforms) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::tube(10, 16), test::bar(2, 9)})
    for (const auto& [name, linear] : test::linear_maps()) {
      SCOPED_TRACE(mesh.name + ", " + name);
      Region region = test::two_handles(test::make_scene(mesh));
      for (Handle& handle : region.handles) handle.constrain_transform = false;
      const SystemScene scene(mesh, region);
      const auto found = scene.rotations->find(scene.all_moved(test::about_middle(mesh, linear)), {});
      EXPECT_EQ(found.linear, linear.determinant() < 0);
      EXPECT_LT(deviation_from(found.problem.field.maps, linear), 1e-8);
    }
}

TEST(RotationField, KeepsTheGivenMaps) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const DeformerOptions& options : {corotational, blend_only}) {
      SCOPED_TRACE(mesh.name);
      const test::Scene ends = test::make_scene(mesh);
      const SystemScene scene(mesh, test::two_handles(ends), options);
      const auto constraints = scene.constraints(head_moved(ends));
      const auto found = scene.rotations->find(constraints, {});
      int given = 0;
      for (const VertexConstraint& constraint : constraints) {
        const Index v = scene.system->patch().local(constraint.vertex);
        if (v < 0 || scene.system->rings()[v].empty()) continue;
        EXPECT_LT((map_at(found.problem.field.maps, v) - *constraint.transform).norm(), 1e-12);
        ++given;
      }
      EXPECT_GT(given, 0);
    }
}

TEST(RotationField, BlendsRotationsWithAllTheirTurns) {
  const Vector3d axis = Vector3d(1, 1, -2).normalized();
  for (const test::TestMesh& mesh : test::small_families())
    for (const double angle : {0.4, 2.5, 10.0, -7.0}) {
      SCOPED_TRACE(mesh.name + ", " + std::to_string(angle));
      const test::Scene ends = test::make_scene(mesh);
      const SystemScene scene(mesh, test::held_foot(ends), blend_only);
      HandlePose pose;
      pose.rotation = Eigen::AngleAxisd(angle, axis);
      pose.transform.linear() = pose.rotation->toRotationMatrix();
      const auto found = scene.rotations->find(scene.constraints(std::vector{pose}), {});
      const Patch& patch = scene.system->patch();
      Columns share = Columns::Zero(patch.size(), 1);
      for (const Index v : ends.head)
        if (patch.local(v) >= 0) share(patch.local(v), 0) = 1;
      share = scene.rotations->fields().spread(share);
      const LimbTwist& limbs = scene.rotations->limbs();
      const Columns slope = limbs.empty() ? Columns::Zero(patch.size(), 1) : limbs.slopes(share, {});
      for (Index v = 0; v < patch.size(); ++v) {
        const Vector3d turn = share(v, 0) * angle * axis;
        Matrix3d expected = rotation_exp(turn);
        if (!limbs.empty())
          expected *= Matrix3d::Identity() + twist_shear(limbs.at(v), turn, slope(v, 0) * angle * axis,
                                                         Matrix3d::Identity(), Matrix3d::Identity()) *
                                                 limbs.at(v).moment * limbs.at(v).axis.transpose();
        EXPECT_LT((map_at(found.problem.field.maps, v) - expected).norm(), 1e-8);
      }
    }
}

TEST(RotationField, TurnsWithAMotionOfAllHandles) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const DeformerOptions& options : {corotational, blend_only}) {
      SCOPED_TRACE(mesh.name);
      const test::Scene ends = test::make_scene(mesh);
      const SystemScene scene(mesh, test::two_handles(ends), options);
      const auto constraints = scene.constraints(head_moved(ends));
      const auto plain = scene.rotations->find(constraints, {});
      const auto moved = scene.rotations->find(moved_afterwards(constraints, any_motion()), {});
      EXPECT_EQ(moved.iterations, plain.iterations);
      const Matrix3d Q = any_motion().linear();
      for (Index v = 0; v < scene.system->patch().size(); ++v) {
        const Matrix3d expected = Q * map_at(plain.problem.field.maps, v);
        EXPECT_LT((map_at(moved.problem.field.maps, v) - expected).norm(), 1e-6);
      }
    }
}

TEST(RotationField, TurnsWithTheScene) {
  const Matrix3d Q = any_motion().linear();
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const test::Scene ends = test::make_scene(mesh);
    const Region region = test::held_foot(ends);
    const SystemScene scene(mesh, region), turned(test::transformed(mesh, any_motion(), "turned"), region);
    auto constraints = scene.constraints(std::vector{test::pose_of(test::head_move(ends))});
    const auto plain = scene.rotations->find(constraints, {});
    constraints = moved_afterwards(constraints, any_motion());
    for (VertexConstraint& constraint : constraints)
      constraint.transform = Matrix3d(*constraint.transform * Q.transpose());
    const auto moved = turned.rotations->find(constraints, {});
    EXPECT_GT(deviation_from(plain.problem.field.maps, Matrix3d::Identity()), 0.1);
    for (Index v = 0; v < scene.system->patch().size(); ++v) {
      const Matrix3d expected = Q * map_at(plain.problem.field.maps, v) * Q.transpose();
      EXPECT_LT((map_at(moved.problem.field.maps, v) - expected).norm(), 1e-5);
    }
  }
}

TEST(RotationField, IsBlendedLinearlyWhereATransformHasNoLogarithm) {
  const Matrix3d mirror = any_motion().linear() * Vector3d(1, -1, 1).asDiagonal(),
                 flat = any_motion().linear() * Vector3d(1, 1, 0).asDiagonal();
  for (const test::TestMesh& mesh : test::small_families())
    for (const Matrix3d& linear : {mirror, flat}) {
      SCOPED_TRACE(mesh.name);
      const test::Scene ends = test::make_scene(mesh);
      const SystemScene scene(mesh, test::two_handles(ends));
      const Eigen::Affine3d map = test::about_middle(mesh, linear);
      const auto found =
          scene.rotations->find(scene.constraints(std::vector{HandlePose{}, test::pose_of(map)}), {});
      EXPECT_TRUE(found.linear);
      EXPECT_EQ(found.iterations, 0);
      EXPECT_FALSE(found.problem.field.smooth);
      // Entry by entry, the maps of the edges are those of the head times one number.
      Columns share = Columns::Zero(scene.system->patch().size(), 1);
      for (const Index v : ends.head)
        if (scene.system->patch().local(v) >= 0) share(scene.system->patch().local(v), 0) = 1;
      share = scene.rotations->fields().spread(share);
      for (Index v = 0; v < scene.system->patch().size(); ++v) {
        const Matrix3d expected = Matrix3d::Identity() + share(v, 0) * (linear - Matrix3d::Identity());
        EXPECT_LT((map_at(found.problem.field.maps, v) - expected).norm(), 1e-8);
      }
    }
}

TEST(RotationField, WithoutIterationsIsTheBlend) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const test::Scene ends = test::make_scene(mesh);
    const Region region = test::held_foot(ends);
    const SystemScene none(mesh, region, {.iterations = 0}), blend(mesh, region, blend_only);
    EXPECT_EQ(none.rotations->iterations(), 0);
    EXPECT_EQ(blend.rotations->iterations(), 0);
    const auto constraints = none.constraints(std::vector{test::pose_of(test::head_move(ends))});
    const auto a = none.rotations->find(constraints, {}), b = blend.rotations->find(constraints, {});
    EXPECT_EQ(a.problem.field.maps, b.problem.field.maps);
    for (const auto& found : {a, b}) {
      EXPECT_EQ(found.iterations, 0);
      EXPECT_EQ(found.change, 0);
    }
  }
}

TEST(RotationField, StopsWhenSettledOrAfterTheLargestNumberOfSteps) {
  for (const test::TestMesh& mesh : test::small_families()) {
    const test::Scene ends = test::make_scene(mesh);
    double first = 0;
    for (const int limit : {1, 3, 40}) {
      SCOPED_TRACE(mesh.name + ", " + std::to_string(limit));
      const SystemScene scene(mesh, test::held_foot(ends), {.iterations = limit});
      const auto found =
          scene.rotations->find(scene.constraints(std::vector{test::pose_of(test::head_move(ends))}), {});
      EXPECT_GE(found.iterations, 1);
      EXPECT_LE(found.iterations, limit);
      if (found.iterations < limit) {
        EXPECT_LT(found.change, settled_change);
      }
      if (limit == 1) first = found.change;
      EXPECT_LE(found.change, first);
      if (limit == 40) {
        EXPECT_LT(found.change, settled_change);
      }
    }
  }
}

TEST(RotationField, ASettledFieldHasTheRotationsOfItsOwnSolution) {
  // One more step from there asks for no more than the last one did.
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const test::Scene ends = test::make_scene(mesh);
    const Region region = test::held_foot(ends);
    const SystemScene scene(mesh, region, {.iterations = 40});
    const auto constraints = scene.constraints(std::vector{test::pose_of(test::head_move(ends))});
    const auto settled = scene.rotations->find(constraints, {});
    const SystemScene longer(mesh, region, {.iterations = settled.iterations});
    const auto again = longer.rotations->find(constraints, {});
    EXPECT_EQ(again.problem.field.maps, settled.problem.field.maps);
    const ConstrainedSystem::Known values = scene.system->known_values(constraints);
    const Columns before = scene.system->maps(settled.problem.guess, values, {});
    const Columns y = scene.system->solve(values, settled.problem.field, {}, {});
    const Columns after = scene.system->maps(y, values, {});
    EXPECT_LT((after - before).norm(), 0.02 * before.norm());
  }
}

TEST(RotationField, TheDefaultNumberOfStepsIsWithinAThousandthOfTheSettledResult) {
  for (const test::TestMesh& mesh : test::mesh_families())
    for (const double angle : {45.0, 120.0}) {
      SCOPED_TRACE(mesh.name + ", " + std::to_string(angle));
      const test::Scene ends = test::make_scene(mesh);
      const Region region = test::held_foot(ends);
      const SystemScene scene(mesh, region), longer(mesh, region, {.iterations = 200});
      const HandlePose pose = test::turned(ends, angle);
      const auto constraints = scene.constraints(std::vector{pose});
      const ConstrainedSystem::Known values = scene.system->known_values(constraints);
      const auto displacements = [&](const RotationField::Result& found) {
        const Columns y = scene.system->solve(values, found.problem.field, {.corrections = 1}, {});
        return scene.system->displacements(y, values, {});
      };
      const Columns usual = displacements(scene.rotations->find(constraints, {}));
      const Columns settled = displacements(longer.rotations->find(constraints, {}, 1e-6));
      // Triangles of 1:1000 need more steps than the default.
      const bool needles = mesh.name.find("needle") != std::string::npos;
      EXPECT_LT((usual - settled).norm(), (needles ? 1e-2 : 1e-3) * settled.norm());
    }
}

TEST(RotationField, OfASharedPatchIsThatOfOneSetUpAlone) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::irregular_grid(22, 16)}) {
    SCOPED_TRACE(mesh.name);
    const test::Scene ends = test::make_scene(mesh);
    const Region region = test::held_foot(ends);
    Region more = region;
    for (Index v = 0; more.handles.size() < 2; ++v)
      if (std::find(ends.foot.begin(), ends.foot.end(), v) == ends.foot.end() &&
          std::find(ends.head.begin(), ends.head.end(), v) == ends.head.end())
        more.handles.push_back(test::make_handle("one", {v}));
    const SystemScene whole(mesh, region), shared(mesh, more, {}, &whole), alone(mesh, more);
    EXPECT_TRUE(shared.summary.reused);
    EXPECT_EQ(shared.rotations->normals().data(), whole.rotations->normals().data());
    const auto constraints =
        shared.constraints(std::vector{test::pose_of(test::head_move(ends)), HandlePose{}});
    const auto a = shared.rotations->find(constraints, {}), b = alone.rotations->find(constraints, {});
    EXPECT_EQ(a.iterations, b.iterations);
    const Patch& patch = alone.system->patch();
    for (Index v = 0; v < patch.size(); ++v) {
      const Index among_more = shared.system->patch().local(patch.vertices[v]);
      ASSERT_GE(among_more, 0);
      const Matrix3d expected = map_at(b.problem.field.maps, v);
      EXPECT_LT((map_at(a.problem.field.maps, among_more) - expected).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace meshgraft
