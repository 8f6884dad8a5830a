// Results do not depend on order, pose, size, location or orientation of the mesh.
#include <algorithm>
#include <numeric>
#include <random>
#include <utility>
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
using Eigen::Vector3d;

/// Returns the scene with its vertices and triangles in another order: vertex i becomes `place[i]`.
Scene shuffled(const Scene& scene, std::vector<Index>& place) {
  std::mt19937 random(11);
  const auto shuffle = [&](auto& list) {
    for (std::size_t k = list.size() - 1; k > 0; --k) std::swap(list[k], list[random() % (k + 1)]);
  };
  place.resize(static_cast<std::size_t>(scene.mesh.size()));
  std::iota(place.begin(), place.end(), 0);
  shuffle(place);
  std::vector<Eigen::Index> faces(static_cast<std::size_t>(scene.mesh.triangles.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  shuffle(faces);

  Scene result{scene.mesh, {}, {}};
  for (Index v = 0; v < scene.mesh.size(); ++v)
    result.mesh.positions.row(place[static_cast<std::size_t>(v)]) = scene.mesh.positions.row(v);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int c = 0; c < 3; ++c)
      result.mesh.triangles(faces[f], c) = place[static_cast<std::size_t>(
          scene.mesh.triangles(static_cast<Eigen::Index>(f), (c + static_cast<int>(f)) % 3))];
  for (Index v : scene.foot) result.foot.push_back(place[static_cast<std::size_t>(v)]);
  for (Index v : scene.head) result.head.push_back(place[static_cast<std::size_t>(v)]);
  return result;
}

TEST(Laws, OrderDoesNotMatter) {
  for (const TestMesh& mesh : mesh_families())
    for (const OperatorOptions& options : operator_variants(smooth_treatments)) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      std::vector<Index> place;
      const Scene other = shuffled(scene, place);
      const Points expected = edit_head(scene, options), reordered = edit_head(other, options);
      Points result(mesh.size(), 3);
      for (Index v = 0; v < mesh.size(); ++v) result.row(v) = reordered.row(place[static_cast<std::size_t>(v)]);
      EXPECT_LT(largest_distance(result, expected), std::max(1e-9 * mesh.box_diagonal(), eight_ulp(expected)));
    }
}

TEST(Laws, ASimilarityOfTheSceneCarriesTheResultAlong) {
  for (const TestMesh& mesh : mesh_families()) {
    // Skips scenes at 1e9: moving them away from there changes how their coordinates are rounded.
    if (mesh.positions.cwiseAbs().maxCoeff() > 1e6) continue;
    const double size = mesh.box_diagonal();
    const Affine3d similarity = Eigen::Translation3d(size * Vector3d(2, -1, 3)) *
                                Eigen::AngleAxisd(1.9, Vector3d(-1, 1, 3).normalized()) * Eigen::Scaling(3.7);
    for (const OperatorOptions& options : operator_variants(smooth_treatments))
      for (const bool anchored : {false, true}) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + (anchored ? ", anchored" : ""));
        const Scene scene = make_scene(mesh);
        Scene other = scene;
        other.mesh = transformed(mesh, similarity, "");
        Region region = held_foot(scene), other_region = region;
        const Affine3d move = head_move(scene);
        if (anchored)
          for (Index v = 0; v < mesh.size(); v += 5) {
            const Vector3d target = Vector3d(mesh.positions.row(v)) + 0.1 * size * Vector3d(0, 1, 0);
            region.anchors.push_back({v, 0.3, target});
            other_region.anchors.push_back({v, 0.3, similarity * target});
          }
        const Points result = make_deformer(scene, region, options).evaluate(std::vector{pose_of(move)});
        const Points other_result =
            make_deformer(other, other_region, options)
                .evaluate(std::vector{pose_of(similarity * move * similarity.inverse())});
        double error = 0;
        const Points expected = image(result, similarity);
        for (Index v : mesh.triangles.reshaped())
          error = std::max(error, (other_result.row(v) - expected.row(v)).norm());
        EXPECT_LT(error, 3.7e-9 * size);
      }
  }
}

// Uses meshes without thin triangles at 1e9: distance may cost only the rounding of the coordinates.
TEST(Laws, DistanceFromTheOriginCostsOnlyTheCoordinatesRounding) {
  for (const TestMesh& mesh : {bumpy_sphere(3), flat_sheet(18, 12), tube(14, 30), irregular_grid(22, 16)})
    for (const OperatorOptions& options : operator_variants(smooth_treatments)) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene far = make_scene(far_away(mesh));
      Scene near = far;  // the same rounded shape, since the subtraction is exact
      near.mesh.positions.rowwise() -= far_offset().transpose();
      const double ulp = eight_ulp(far.mesh.positions) / 8;
      const Affine3d shift(Eigen::Translation3d(0.25, -0.5, 0.75));
      const Points near_result =
          make_deformer(near, held_foot(near), options).evaluate(std::vector{pose_of(shift)});
      const Points far_result =
          make_deformer(far, held_foot(far), options).evaluate(std::vector{pose_of(shift)});
      const Points back = far_result.rowwise() - far_offset().transpose();
      EXPECT_LE((back - near_result).cwiseAbs().maxCoeff(), ulp);
      // At that distance each product of matrices rounds the turn's matrix as well.
      const Affine3d move = head_move(near), to(Eigen::Translation3d{far_offset()});
      const Points near_turn =
          make_deformer(near, held_foot(near), options).evaluate(std::vector{pose_of(move)});
      const Points far_turn =
          make_deformer(far, held_foot(far), options).evaluate(std::vector{pose_of(to * move * to.inverse())});
      EXPECT_LE((far_turn.rowwise() - far_offset().transpose() - near_turn).cwiseAbs().maxCoeff(), 16 * ulp);
    }
}

TEST(Laws, SizeDoesNotMatter) {
  for (const TestMesh& mesh : {bumpy_sphere(3), flat_sheet(18, 12), bar(3, 14)})
    for (const double factor : {1e-6, 1e6}) {
      const Scene scene = make_scene(mesh);
      Scene other = scene;
      other.mesh.positions *= factor;
      const Points result = edit_head(scene), other_result = edit_head(other);
      EXPECT_LT(largest_distance(other_result, factor * result), 1e-11 * factor * mesh.box_diagonal())
          << mesh.name;
    }
}

TEST(Laws, WindingDoesNotMatter) {
  for (const TestMesh& mesh : {bumpy_sphere(3), flat_sheet(14, 14), irregular_grid(18, 12), torus(14, 20)}) {
    const Scene scene = make_scene(mesh);
    Scene mixed = scene;
    for (Index t = 1; t < mixed.mesh.triangles.rows(); t += 2)
      std::swap(mixed.mesh.triangles(t, 1), mixed.mesh.triangles(t, 2));
    SCOPED_TRACE(mesh.name);
    EXPECT_LT(largest_distance(edit_head(scene), edit_head(mixed)), 1e-9 * mesh.box_diagonal());
  }
}

/// Lists every face twice, in opposite orientations, so that the normals cancel everywhere.
TEST(Laws, TwoSidedSheetsAreSolvable) {
  TestMesh sheet = flat_sheet(12, 12);
  const Index faces = static_cast<Index>(sheet.triangles.rows());
  sheet.triangles.conservativeResize(2 * faces, Eigen::NoChange);
  for (Index t = 0; t < faces; ++t)
    sheet.triangles.row(faces + t) << sheet.triangles(t, 0), sheet.triangles(t, 2), sheet.triangles(t, 1);
  const Scene scene = make_scene(sheet);
  const Deformer deformer = make_deformer(scene, held_foot(scene));
  EXPECT_LT(deformer.condition_estimate(), 1e12);
  EXPECT_TRUE(deformer.evaluate(std::vector{pose_of(head_move(scene))}).allFinite());
}

TEST(Laws, OrdersDiffer) {
  const Scene scene = make_scene(irregular_grid(22, 16));
  OperatorOptions options;
  std::vector<Points> results;
  for (options.laplacian_order = 1; options.laplacian_order <= 3; ++options.laplacian_order)
    results.push_back(edit_head(scene, options));
  EXPECT_GT(largest_distance(results[0], results[1]), 1e-4);
  EXPECT_GT(largest_distance(results[1], results[2]), 1e-4);
}

}  // namespace
}  // namespace meshgraft::test
