// Settings under which the methods agree, and settings that are refused.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "deform/solve/stiffness_edges.h"
#include "rotating_methods.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Methods, WithNothingTurnedAndNoStiffnessRotationAwareIsLinear) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const std::vector shift{
        pose_of(Affine3d(Eigen::Translation3d(0.1 * mesh.box_diagonal() * Vector3d(1, 2, 3))))};
    const Points aware =
        make_deformer(scene, held_foot(scene), options_of(DeformMethod::rotation_aware, 0)).evaluate(shift);
    EXPECT_TRUE(same_bytes(aware, make_deformer(scene, held_foot(scene), linear_method()).evaluate(shift)));
  }
}

TEST(StiffnessScale, MoreIsNeverSofterOnCoarseComponents) {
  for (const double vertices : {10.0, 500.0, 1500.0, 3000.0, 4500.0, 6000.0, 1e6}) {
    double before = 0;
    for (double stiffness = 1; stiffness < 1e4; stiffness *= 1.1) {
      const double scaled = stiffness * stiffness_scale(0.1, {.area = 4, .vertices = vertices}, stiffness);
      EXPECT_GE(scaled, before * (1 - 1e-12)) << vertices << ", " << stiffness;
      EXPECT_LE(scaled, stiffness * 0.05 * (1 + 1e-12));
      EXPECT_GE(scaled, stiffness * 0.05 / 4 * (1 - 1e-12));
      before = scaled;
    }
  }
  // The default is as strong as the layer of two edges at the border allows, from a quarter on.
  const double usual = DeformerOptions().stiffness;
  for (const auto& [vertices, share] :
       {std::pair{10.0, 0.25}, {2000.0, std::sqrt(3) / 2 * 2000 / (63 * 63)}, {1e5, 1.0}})
    EXPECT_NEAR(stiffness_scale(0.1, {.area = 4, .vertices = vertices}, usual), 0.05 * share, 1e-12);
}

TEST(Methods, WhereAllPositionsAreGivenTheyAreKept) {
  // Positions alone: the transforms are free, but there is nothing to solve.
  const TestMesh mesh = tube(8, 4);
  Region region;
  region.whole = true;
  Points wanted = mesh.positions;
  wanted.col(2) *= 2;
  std::vector<VertexConstraint> constraints;
  for (Index v = 0; v < mesh.positions.rows(); ++v) {
    VertexConstraint constraint;
    constraint.vertex = v;
    constraint.position = wanted.row(v).transpose();
    constraints.push_back(constraint);
  }
  for (const DeformMethod method :
       {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
    const Deformer deformer({mesh.positions, mesh.triangles, region, constraints}, options_of(method));
    EXPECT_TRUE(same_bytes(deformer.evaluate(constraints), wanted));
  }
}

TEST(Methods, NoStepsIsRotationAware) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    DeformerOptions still;
    still.iterations = 0;
    EXPECT_TRUE(
        same_bytes(edit_head(scene, still), edit_head(scene, options_of(DeformMethod::rotation_aware))));
  }
}

TEST(Methods, ReflectionsAndFlatteningsFallBackToLinear) {
  const Scene scene = make_scene(tube(14, 30));
  Matrix3d flat = Matrix3d::Identity();
  flat(2, 2) = 0;
  Matrix3d mirror = Matrix3d::Identity();
  mirror(0, 0) = -1;
  for (const Matrix3d& linear : {flat, mirror}) {
    const std::vector poses{pose_of(about_middle(scene.mesh, linear))};
    const Points expected = make_deformer(scene, held_foot(scene), linear_method()).evaluate(poses);
    for (const DeformMethod method : rotating_methods) {
      EvaluationReport report;
      const Points result =
          make_deformer(scene, held_foot(scene), options_of(method, 0)).evaluate(poses, {}, &report);
      EXPECT_TRUE(report.fell_back_to_linear);
      EXPECT_TRUE(same_bytes(result, expected));
      const Points stiff = make_deformer(scene, held_foot(scene), options_of(method)).evaluate(poses);
      EXPECT_TRUE(stiff.allFinite());
    }
  }
}

TEST(Methods, ParametersOutOfRangeAreRefused) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DeformerOptions& options :
       {DeformerOptions{.stiffness = -1}, DeformerOptions{.stiffness = nan}, DeformerOptions{.iterations = -1},
        DeformerOptions{.iterations = 1'000'000}, DeformerOptions{.smoothing_length_rel = nan},
        DeformerOptions{.smoothing_length_rel = -0.1}})
    EXPECT_THROW(make_deformer(scene, held_foot(scene), options), Error);
}

}  // namespace
}  // namespace meshgraft::test
