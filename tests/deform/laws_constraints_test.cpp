// Results follow constraints, anchors and rotation fields.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "linalg/sparse.h"
#include "linear_edits.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

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
  const Deformer by_vertices({scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints},
                             linear_method());
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
  const Deformer deformer({rest, scene.mesh.triangles, {.whole = true}, constraints}, linear_method(options));
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
  const Deformer deformer({scene.mesh.positions, scene.mesh.triangles, {.vertices = region}, constraints},
                          linear_method());
  const Points result = deformer.evaluate(constraints);
  for (Index v : scene.head) EXPECT_EQ(result.row(v), scene.mesh.positions.row(v));
}

TEST(Laws, ComponentsWithoutAFreeVertexNeedNoConstraints) {
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

}  // namespace
}  // namespace meshgraft::test
