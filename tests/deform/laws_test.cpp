// Laws that every deformation obeys, over families of meshes and all settings.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Degenerate treatments whose thresholds rounding does not cross.
const std::vector<DegenerateTreatment> smooth_treatments{DegenerateTreatment::apex};

Deformer make_deformer(const Scene& scene, const Region& region, const OperatorOptions& options = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, linear_method(options)};
}

Points edit_head(const Scene& scene, const OperatorOptions& options = {}) {
  return make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(head_move(scene))});
}

/// Checks that the vertices of faces follow `map`.
void expect_affine(const TestMesh& mesh, const Points& result, const Affine3d& map) {
  const Points expected = image(mesh.positions, map);
  double error = 0;
  for (Index v : mesh.triangles.reshaped()) error = std::max(error, (result.row(v) - expected.row(v)).norm());
  EXPECT_LE(error, std::max({1e-10 * mesh.box_diagonal(), eight_ulp(expected), eight_ulp(mesh.positions)}));
}

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

TEST(Laws, OrdersDiffer) {
  const Scene scene = make_scene(irregular_grid(22, 16));
  OperatorOptions options;
  std::vector<Points> results;
  for (options.laplacian_order = 1; options.laplacian_order <= 3; ++options.laplacian_order)
    results.push_back(edit_head(scene, options));
  EXPECT_GT(largest_distance(results[0], results[1]), 1e-4);
  EXPECT_GT(largest_distance(results[1], results[2]), 1e-4);
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

TEST(Laws, ConstraintsAreMetToTheBit) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Deformer deformer = make_deformer(scene, held_foot(scene));
    const std::vector poses{pose_of(head_move(scene))};
    const Points result = deformer.evaluate(poses);
    const auto constraints = deformer.constraints(poses);
    ASSERT_EQ(constraints.size(), scene.head.size());
    for (const VertexConstraint& constraint : constraints) {
      EXPECT_EQ(Vector3d(result.row(constraint.vertex)), *constraint.position);
      EXPECT_EQ(*constraint.position, head_move(scene) * Vector3d(mesh.positions.row(constraint.vertex)));
    }
    for (Index v : scene.foot) EXPECT_EQ(result.row(v), mesh.positions.row(v));
    std::vector<bool> used(static_cast<std::size_t>(mesh.size()), false);
    for (Index v : mesh.triangles.reshaped()) used[static_cast<std::size_t>(v)] = true;
    for (Index v = 0; v < mesh.size(); ++v)
      if (!used[static_cast<std::size_t>(v)]) {
        EXPECT_EQ(result.row(v), mesh.positions.row(v));
      }
  }
}

TEST(Laws, HandlesAndVertexConstraintsAreTheSameEdit) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Deformer by_handles = make_deformer(scene, two_handles(scene));
  const std::vector poses{HandlePose{}, pose_of(head_move(scene))};
  const auto constraints = by_handles.constraints(poses);
  const Deformer by_vertices = Deformer::with_constraints(scene.mesh.positions, scene.mesh.triangles, {},
                                                          constraints, {}, {}, linear_method());
  EXPECT_TRUE(same_bytes(by_vertices.evaluate(constraints), by_handles.evaluate(poses)));
  // A rotation field of identities gives the FT05 result, too.
  const std::vector<Matrix3d> identities(static_cast<std::size_t>(scene.mesh.size()), Matrix3d::Identity());
  EXPECT_LT(
      largest_distance(by_vertices.evaluate_with_field(constraints, identities), by_handles.evaluate(poses)),
      1e-12);
}

TEST(Laws, ResultsAreLinearInThePose) {
  const Scene scene = make_scene(irregular_grid(22, 16));
  const Deformer deformer = make_deformer(scene, held_foot(scene));
  const Affine3d move = head_move(scene);
  Affine3d half;
  half.matrix() = 0.5 * (move.matrix() + Eigen::Matrix4d::Identity());
  const Points whole = deformer.evaluate(std::vector{pose_of(move)});
  const Points middle = deformer.evaluate(std::vector{pose_of(half)});
  EXPECT_LT(largest_distance(middle, 0.5 * (whole + scene.mesh.positions)), 1e-12);
}

TEST(Laws, SeveralHandlesGoWhereTheyAreSent) {
  const TestMesh mesh = bumpy_sphere(3);
  Scene scene = make_scene(mesh);
  Region region = held_foot(scene);
  Handle left = make_handle("left", {}), right = make_handle("right", {});
  for (Index v = 0; v < mesh.size(); ++v) {
    if (std::abs(mesh.positions(v, 2)) > 0.4) continue;
    if (mesh.positions(v, 0) > 0.75) right.vertices.push_back(v);
    if (mesh.positions(v, 0) < -0.75) left.vertices.push_back(v);
  }
  right.constrain_transform = false;
  region.handles.push_back(left);
  region.handles.push_back(right);
  const std::vector poses{pose_of(head_move(scene)), pose_of(Affine3d(Eigen::Translation3d(-0.3, 0.2, 0))),
                          pose_of(Affine3d(Eigen::Translation3d(0.3, 0.1, 0.1)))};
  const Points result = make_deformer(scene, region).evaluate(poses);
  for (std::size_t h = 0; h < poses.size(); ++h)
    for (Index v : region.handles[h].vertices)
      EXPECT_EQ(Vector3d(result.row(v)), poses[h].transform * Vector3d(mesh.positions.row(v)));
  EXPECT_LT(largest_distance(result, mesh.positions), 3 * mesh.box_diagonal());
}

/// Returns anchors on every second vertex of a sheet's middle part, with shifted targets if `shift` is given.
std::vector<Anchor> middle_anchors(const TestMesh& sheet, double weight, const Vector3d* shift) {
  std::vector<Anchor> anchors;
  for (Index v = 0; v < sheet.size(); v += 2) {
    const Vector3d p = sheet.positions.row(v);
    if (p.x() < 0.8 || p.x() > 1.2) continue;
    anchors.push_back({v, weight, {}});
    if (shift != nullptr) anchors.back().target = p + *shift;
  }
  return anchors;
}

TEST(Laws, AnchorsPullAsHardAsTheyWeigh) {
  const TestMesh mesh = flat_sheet(18, 12);
  const Scene scene = make_scene(mesh);
  const Vector3d shift(0, 0, 0.5);
  for (const Density density : {Density::ft05, Density::aware}) {
    double previous = 0.5;
    for (const double weight : {0.1, 1.0, 10.0, 100.0, 1000.0, 10000.0}) {
      Region region = held_foot(scene);
      region.anchors = middle_anchors(mesh, weight, &shift);
      const Points result =
          make_deformer(scene, region, {.density = density}).evaluate(std::vector{HandlePose{}});
      double distance = 0;
      for (const Anchor& anchor : region.anchors)
        distance = std::max(distance, (Vector3d(result.row(anchor.vertex)) - *anchor.target).norm());
      EXPECT_LT(distance, previous) << weight;
      previous = distance;
    }
    EXPECT_LT(previous, 0.05);
  }
}

TEST(Laws, AnchorsWithoutTargetHoldTheRestPosition) {
  const TestMesh mesh = flat_sheet(18, 12);
  const Scene scene = make_scene(mesh);
  const std::vector lift{pose_of(Affine3d(Eigen::Translation3d(0, 0, 0.5)))};
  for (const Density density : {Density::ft05, Density::aware}) {
    Region region = held_foot(scene);
    const Points loose = make_deformer(scene, region, {.density = density}).evaluate(lift);
    region.anchors = middle_anchors(mesh, 1000, nullptr);
    const Points held = make_deformer(scene, region, {.density = density}).evaluate(lift);
    for (const Anchor& anchor : region.anchors)
      EXPECT_LT(std::abs(held(anchor.vertex, 2)), 0.5 * loose(anchor.vertex, 2));
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

/// A long sheet whose middle is edited.
struct LocalEdit {
  TestMesh mesh = irregular_grid(60, 8);
  Region region;
  std::vector<Index> far;  ///< vertices at both ends, beyond the edit's reach

  LocalEdit() {
    Handle handle = make_handle("middle", {});
    for (Index v = 0; v < mesh.size(); ++v) {
      const Index column = v % 61;
      if (column >= 20 && column <= 40) region.vertices.push_back(v);
      if (column == 30 || column == 31) handle.vertices.push_back(v);
      if (column < 13 || column > 47) far.push_back(v);
    }
    region.handles = {handle};
  }
  Points result(const OperatorOptions& options) const {
    return Deformer(mesh.positions, mesh.triangles, region, linear_method(options))
        .evaluate(std::vector{
            pose_of(Affine3d(Eigen::Translation3d(0, 0, 0.1) * Eigen::AngleAxisd(0.3, Vector3d::UnitY())))});
  }
};

TEST(Laws, WhatLiesBeyondReachHasNoSay) {
  for (const OperatorOptions& options : operator_variants()) {
    SCOPED_TRACE(describe(options));
    const LocalEdit edit;
    const Points expected = edit.result(options);
    for (const double value : {12.5, std::numeric_limits<double>::quiet_NaN()}) {
      LocalEdit other;
      for (Index v : other.far) other.mesh.positions(v, 1) += value;
      const Points result = other.result(options);
      std::vector<bool> is_far(static_cast<std::size_t>(edit.mesh.size()), false);
      for (Index v : edit.far) is_far[static_cast<std::size_t>(v)] = true;
      for (Index v = 0; v < edit.mesh.size(); ++v) {
        if (is_far[static_cast<std::size_t>(v)]) {
          EXPECT_EQ(result(v, 0), other.mesh.positions(v, 0));
        } else {
          EXPECT_EQ(result.row(v), expected.row(v)) << "vertex " << v;
        }
      }
    }
  }
}

TEST(Laws, VerticesOutsideTheRegionKeepTheirBits) {
  const LocalEdit edit;
  const Points result = edit.result({});
  std::vector<bool> inside(static_cast<std::size_t>(edit.mesh.size()), false);
  for (Index v : edit.region.vertices) inside[static_cast<std::size_t>(v)] = true;
  Index moved = 0;
  for (Index v = 0; v < edit.mesh.size(); ++v) {
    if (inside[static_cast<std::size_t>(v)]) {
      moved += result.row(v) != edit.mesh.positions.row(v) ? 1 : 0;
    } else {
      EXPECT_EQ(result.row(v), edit.mesh.positions.row(v));
    }
  }
  EXPECT_EQ(moved, static_cast<Index>(edit.region.vertices.size()));
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

TEST(Laws, UnrelatedPartsHaveNoSay) {
  const Scene scene = make_scene(irregular_grid(18, 12));
  const Index n = scene.mesh.size();
  // Adds a second component that is larger, coarser and far to the side.
  TestMesh other =
      transformed(irregular_grid(9, 6), Affine3d(Eigen::Translation3d(40, 0, 0) * Eigen::Scaling(3.0)), "");
  TestMesh both = scene.mesh;
  both.positions.conservativeResize(n + other.size(), Eigen::NoChange);
  both.positions.bottomRows(other.size()) = other.positions;
  const auto faces = both.triangles.rows();
  both.triangles.conservativeResize(faces + other.triangles.rows(), Eigen::NoChange);
  both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + n;
  for (OperatorOptions options : operator_variants()) {
    for (const int order : {1, 2, 3}) {
      options.laplacian_order = order;
      Region alone;
      alone.fixed = scene.foot;
      for (Index v = 0; v < n; ++v) alone.vertices.push_back(v);
      alone.handles.push_back(make_handle("head", scene.head));
      Region with_other = alone;
      with_other.fixed.push_back(n);  // a corner of the other component, which is otherwise free
      for (Index v = n; v < both.size(); ++v) with_other.vertices.push_back(v);
      const std::vector<HandlePose> pose{pose_of(head_move(scene))};
      const DeformerOptions all = linear_method(options);
      const Points a = Deformer(both.positions, both.triangles, alone, all).evaluate(pose);
      const Points b = Deformer(both.positions, both.triangles, with_other, all).evaluate(pose);
      EXPECT_LT(largest_distance(a, b), 1e-9 * scene.mesh.box_diagonal())
          << describe(options) << ", order " << order;
    }
  }
}

/// With a known shape's local maps as the rotation field, E_R vanishes at that shape. Since E_L has almost no
/// weight, the solve must return that shape.
TEST(Laws, TheRotationFieldIsFollowed) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Points& rest = scene.mesh.positions;
  const OperatorOptions options{
      .degenerate = DegenerateTreatment::ft05_noise, .flatness = 0, .laplacian_weight = 1e-6};
  Points shape = rest;
  for (Index v = 0; v < rest.rows(); ++v) {
    const double angle = 0.8 * rest(v, 2);
    shape(v, 0) = std::cos(angle) * rest(v, 0) - std::sin(angle) * rest(v, 1);
    shape(v, 1) = std::sin(angle) * rest(v, 0) + std::cos(angle) * rest(v, 1);
  }
  const AffineOperator op(rest, scene.mesh.triangles, options);
  const Columns maps = multiply(op.H(), Columns(shape));
  std::vector<Matrix3d> field;
  for (Index v = 0; v < rest.rows(); ++v) field.push_back(maps.middleRows<3>(3 * v).transpose());
  std::vector<VertexConstraint> constraints;
  for (const auto* end : {&scene.foot, &scene.head})
    for (Index v : *end) constraints.push_back({v, Vector3d(shape.row(v)), field[static_cast<std::size_t>(v)]});
  const Deformer deformer =
      Deformer::with_constraints(rest, scene.mesh.triangles, {}, constraints, {}, {}, linear_method(options));
  const double twist = largest_distance(rest, shape);
  EXPECT_LT(largest_distance(deformer.evaluate_with_field(constraints, field), shape), 1e-3 * twist);
  EXPECT_GT(largest_distance(deformer.evaluate(constraints), shape), 1e-2 * twist);
}

TEST(Laws, HalfAConstraintOutsideTheRegionFreesNothing) {
  const Scene scene = make_scene(irregular_grid(18, 12));
  std::vector<Index> region;
  for (Index v = 0; v < scene.mesh.size(); ++v)
    if (std::find(scene.head.begin(), scene.head.end(), v) == scene.head.end()) region.push_back(v);
  std::vector<VertexConstraint> constraints;
  for (Index v : scene.foot)
    constraints.push_back({v, Vector3d(scene.mesh.positions.row(v)), Matrix3d(Matrix3d::Identity())});
  for (Index v : scene.head) constraints.push_back({v, {}, Matrix3d(2 * Matrix3d::Identity())});
  const Deformer deformer = Deformer::with_constraints(scene.mesh.positions, scene.mesh.triangles, region,
                                                       constraints, {}, {}, linear_method());
  const Points result = deformer.evaluate(constraints);
  for (Index v : scene.head) EXPECT_EQ(result.row(v), scene.mesh.positions.row(v));
}

TEST(Laws, PartsWithoutAFreeVertexNeedNoConstraints) {
  const Scene scene = make_scene(bumpy_sphere(2));
  TestMesh both = scene.mesh;
  const Index n = both.size();
  both.positions.conservativeResize(n + 3, Eigen::NoChange);
  both.positions.bottomRows(3) << 9, 0, 0, 10, 0, 0, 9, 1, 0;
  both.triangles.conservativeResize(both.triangles.rows() + 1, Eigen::NoChange);
  both.triangles.bottomRows(1) << n, n + 1, n + 2;
  Region region = held_foot(scene);
  region.handles.push_back(make_handle("plate", {n, n + 1, n + 2}));
  region.handles.back().constrain_transform = false;
  const Affine3d lift(Eigen::Translation3d(0, 0, 1));
  const Points result = Deformer(both.positions, both.triangles, region, linear_method())
                            .evaluate(std::vector{pose_of(head_move(scene)), pose_of(lift)});
  EXPECT_EQ(result(n, 2), 1.0);
  EXPECT_LT(largest_distance(result.topRows(n), edit_head(scene)), 1e-9 * scene.mesh.box_diagonal());
}

TEST(Laws, ValuesThatAreNotFiniteAreRefused) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Region anchored = held_foot(scene);
  anchored.anchors.push_back({.vertex = 50, .target = Vector3d(nan, 0, 0)});
  EXPECT_THROW(make_deformer(scene, anchored), Error);
  const Deformer deformer = make_deformer(scene, held_foot(scene));
  HandlePose huge = pose_of(Affine3d(Eigen::Scaling(1e200)));
  EXPECT_THROW(deformer.evaluate(std::vector{huge}), Error);
  const auto constraints = deformer.constraints(std::vector{HandlePose{}});
  std::vector<Matrix3d> field(static_cast<std::size_t>(scene.mesh.size()), Matrix3d::Identity());
  field[3](0, 0) = nan;
  EXPECT_THROW(deformer.evaluate_with_field(constraints, field), Error);
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
