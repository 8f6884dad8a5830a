// Affine maps are reproduced, over families of meshes and all settings.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "linear_edits.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Laws, AffineMapsAreReproduced) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const OperatorOptions& options : operator_variants()) {
      const Deformer deformer = make_deformer(scene, two_handles(scene), options);
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", " + name);
        const Affine3d map = about_middle(mesh, linear);
        expect_affine(mesh, deformer.evaluate(std::vector{pose_of(map), pose_of(map)}), map);
      }
    }
  }
}

TEST(Laws, AffineMapsAreReproducedFromHalfTheConstraints) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const bool position : {true, false}) {
      Region region = two_handles(scene);
      region.handles[1].constrain_position = position;
      region.handles[1].constrain_transform = !position;
      SCOPED_TRACE(mesh.name + (position ? ", head by position" : ", head by transform"));
      const Deformer deformer = make_deformer(scene, region);
      for (const auto& [name, linear] : linear_maps()) {
        const Affine3d map = about_middle(mesh, linear);
        expect_affine(mesh, deformer.evaluate(std::vector{pose_of(map), pose_of(map)}), map);
      }
    }
  }
}

TEST(Laws, AffineMapsAreReproducedFromPositionsAlone) {
  for (const TestMesh& mesh :
       {bumpy_sphere(3), bar(3, 14), tube(14, 30), torus(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    Region region = two_handles(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = false;
    SCOPED_TRACE(mesh.name);
    const Affine3d map = about_middle(mesh, linear_maps()[0].second);
    expect_affine(mesh, make_deformer(scene, region).evaluate(std::vector{pose_of(map), pose_of(map)}), map);
  }
}

TEST(Laws, AffineMapsAreReproducedByHigherOrders) {
  for (const TestMesh& mesh :
       {bumpy_sphere(3), irregular_grid(22, 16), flat_sheet(18, 12), bar(3, 14), octahedron()})
    for (OperatorOptions options : operator_variants())
      for (const int order : {2, 3}) {
        options.laplacian_order = order;
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", order " + std::to_string(order));
        const Scene scene = make_scene(mesh);
        const Affine3d map = about_middle(mesh, linear_maps()[0].second);
        expect_affine(
            mesh,
            make_deformer(scene, two_handles(scene), options).evaluate(std::vector{pose_of(map), pose_of(map)}),
            map);
      }
}

TEST(Laws, AnchorsCarriedAlongKeepAffineMaps) {
  for (const TestMesh& mesh : {bumpy_sphere(3), flat_sheet(18, 12), tube(14, 30)})
    for (const OperatorOptions& options : operator_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      const Affine3d map = about_middle(mesh, linear_maps()[0].second);
      Region region = two_handles(scene);
      for (Index v = 0; v < mesh.size(); v += 7)
        region.anchors.push_back({v, 0.5, map * Vector3d(mesh.positions.row(v))});
      expect_affine(
          mesh, make_deformer(scene, region, options).evaluate(std::vector{pose_of(map), pose_of(map)}), map);
    }
}

/// Returns a feature in the middle of the longest side, where no vertex is constrained.
Feature middle_feature(const Scene& scene) {
  Feature feature;
  const TestMesh& mesh = scene.mesh;
  int axis = 0;
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  (high - low).maxCoeff(&axis);
  for (Index v = 0; v < mesh.size(); ++v) {
    const double place = (mesh.positions(v, axis) - low[axis]) / (high[axis] - low[axis]);
    if (place > 0.45 && place < 0.65) feature.vertices.push_back(v);
  }
  return feature;
}

TEST(Laws, FeaturesKeepOneAffineMap) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), bar(3, 14), irregular_grid(22, 16)})
    for (const OperatorOptions& options : operator_variants(smooth_treatments)) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      Region region = held_foot(scene);
      region.features = {middle_feature(scene)};
      const auto& members = region.features[0].vertices;
      ASSERT_GE(members.size(), 8U);
      const Points result =
          make_deformer(scene, region, options).evaluate(std::vector{pose_of(head_move(scene))});
      const AffineFit fit = fit_affine(mesh.positions, result, members);
      EXPECT_LT(fit.misfit, 1e-10);
      EXPECT_GT((fit.map.linear() - Matrix3d::Identity()).norm(), 1e-2);

      Region free_region = two_handles(scene);
      free_region.features = region.features;
      const Affine3d affine = about_middle(mesh, linear_maps()[0].second);
      expect_affine(
          mesh,
          make_deformer(scene, free_region, options).evaluate(std::vector{pose_of(affine), pose_of(affine)}),
          affine);
    }
}

TEST(Laws, NothingMovesWhenNothingIsMoved) {
  for (const TestMesh& mesh : mesh_families())
    for (const OperatorOptions& options : operator_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      EXPECT_TRUE(same_bytes(
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{HandlePose{}}), mesh.positions));
    }
}

TEST(Laws, ReportsOfAnAffineEditAreClean) {
  for (const TestMesh& mesh : {bumpy_sphere(3), irregular_grid(22, 16), tube(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Deformer deformer = make_deformer(scene, two_handles(scene));
    const HandlePose pose = pose_of(about_middle(mesh, linear_maps()[0].second));
    EvaluationReport affine, bent;
    deformer.evaluate(std::vector{pose, pose}, {}, &affine);
    EXPECT_LT(affine.residual, 1e-10);
    EXPECT_LT(affine.max_transform_deviation, 1e-9);
    deformer.evaluate(std::vector{HandlePose{}, pose_of(head_move(scene))}, {}, &bent);
    EXPECT_LT(bent.residual, 1e-10);
    EXPECT_GT(bent.max_transform_deviation, 1e-3);
    const double condition = deformer.condition_estimate();
    EXPECT_GT(condition, 1);
    EXPECT_TRUE(std::isfinite(condition));
  }
}

}  // namespace
}  // namespace meshgraft::test
