// The rotation-aware and co-rotational methods reproduce affine maps and similarities.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "rotating_methods.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Methods, AffineMapsAreReproduced) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const DeformerOptions& options : method_variants()) {
      const Deformer deformer = make_deformer(scene, two_handles(scene), options);
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", " + name);
        const Affine3d map = about_middle(mesh, linear);
        EvaluationReport report;
        const Points result = deformer.evaluate(std::vector{pose_of(map), pose_of(map)}, {}, &report);
        const Points expected = image(mesh.positions, map);
        const double rounding = std::max(eight_ulp(expected), eight_ulp(mesh.positions)) / mesh.box_diagonal();
        // The equations of their maps are ill conditioned, and each solver rounds in its own way.
        const bool is_ill_conditioned = mesh.name == "needle sheet" || mesh.name == "fan pole";
        const double bound = is_ill_conditioned ? 1e-9 : 1e-10;
        EXPECT_LT(relative_distance(mesh, result, expected), std::max(bound, rounding));
        EXPECT_EQ(report.fell_back_to_linear, linear.determinant() < 0);
      }
    }
  }
}

TEST(Methods, SimilaritiesAreReproducedFromPositionsAlone) {
  for (const TestMesh& mesh : {bumpy_sphere(3), bar(3, 14), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    Region region = two_handles(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = false;
    for (const DeformerOptions& options : method_variants())
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", " + name);
        const Affine3d map = about_middle(mesh, linear);
        const Points result =
            make_deformer(scene, region, options).evaluate(std::vector{pose_of(map), pose_of(map)});
        EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-9);
      }
  }
}

TEST(Methods, AnchorsAndFeaturesKeepSimilarities) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    const Affine3d map =
        about_middle(mesh, Matrix3d(1.6 * AngleAxisd(2.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix()));
    Region anchored = two_handles(scene), with_feature = anchored;
    std::vector<bool> held(static_cast<std::size_t>(mesh.size()), false);
    for (const auto* end : {&scene.foot, &scene.head})
      for (Index v : *end) held[static_cast<std::size_t>(v)] = true;
    Feature feature;
    for (Index v = 0; v < mesh.size(); ++v) {
      if (v % 7 == 0) anchored.anchors.push_back({v, 0.5, map * Vector3d(mesh.positions.row(v))});
      if (v % 3 == 0 && !held[static_cast<std::size_t>(v)]) feature.vertices.push_back(v);
    }
    with_feature.features = {feature};
    for (const DeformerOptions& options : method_variants())
      for (const Region& region : {anchored, with_feature}) {
        SCOPED_TRACE(mesh.name + ", " + describe(options));
        const Points result =
            make_deformer(scene, region, options).evaluate(std::vector{pose_of(map), pose_of(map)});
        EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-10);
      }
  }
}

/// Returns the vertices in the middle third of a mesh along its longest side.
std::vector<Index> middle_of(const TestMesh& mesh) {
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.size(); ++v)
    if (std::abs(mesh.positions(v, axis) - (low[axis] + high[axis]) / 2) < (high[axis] - low[axis]) / 6)
      vertices.push_back(v);
  return vertices;
}

TEST(Methods, SimilarFeaturesStaySimilar) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh, 0.15, 0.12);
    for (const DeformMethod method :
         {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
      for (const std::optional<double> scale : {std::optional<double>(), std::optional<double>(0.8)}) {
        SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)));
        Region region = held_foot(scene);
        region.features = {{middle_of(mesh), true, scale}};
        ASSERT_GT(region.features[0].vertices.size(), 20U);
        Affine3d stretch = pose_of(head_move(scene)).transform;
        stretch.scale(Vector3d(1.5, 0.8, 1.1));
        EvaluationReport report;
        const Points result = make_deformer(scene, region, options_of(method))
                                  .evaluate(std::vector{pose_of(stretch)}, {}, &report);
        const AffineFit fit = fit_affine(mesh.positions, result, region.features[0].vertices);
        EXPECT_LT(fit.misfit, 1e-10);
        const Matrix3d T = fit.map.linear();
        const double found = std::cbrt(T.determinant());
        EXPECT_LT((T.transpose() * T / (found * found) - Matrix3d::Identity()).norm(), 1e-9);
        EXPECT_NEAR(found, scale.value_or(found), 1e-9);
        EXPECT_LT(report.residual, 1e-8);
      }
    }
  }
}

// Checks that a feature carries its vertices however far it extends. Beyond some rings only the feature's map
// reaches them.
TEST(Methods, FeaturesCarryWhatIsDeepInsideThem) {
  const TestMesh mesh = tube(14, 60);
  const Scene scene = make_scene(mesh, 0.1, 0.05);
  Region region{.whole = true};
  region.handles = {{.name = "foot", .vertices = scene.foot}};
  region.features = {{{}, true, {}}};
  region.features[0].vertices = middle_of(mesh);
  const Affine3d map =
      about_middle(mesh, Matrix3d(0.7 * AngleAxisd(1.9, Vector3d(1, 2, -1).normalized()).toRotationMatrix()));
  const Points result = make_deformer(scene, region, {}).evaluate(std::vector{pose_of(map)});
  EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-9);
}

TEST(Methods, NothingMovesWhenNothingIsMoved) {
  for (const TestMesh& mesh : mesh_families())
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      EXPECT_TRUE(same_bytes(
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{HandlePose{}}), mesh.positions));
    }
}

}  // namespace
}  // namespace meshgraft::test
