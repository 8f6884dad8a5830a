#include "merge/flat_loop.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "merge/loop_curve.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

/// Returns a cone from a closed curve to a tip above it, facing outward. Its boundary is the curve, vertices 0
/// … n − 1.
Mesh cone_over(const Points& curve) {
  Mesh cone;
  const auto n = static_cast<Index>(curve.rows());
  cone.positions.resize(n + 1, 3);
  cone.positions << curve, Eigen::RowVector3d(curve.colwise().mean() + Eigen::RowVector3d(0, 0, 3));
  for (Index k = 0; k < n; ++k) cone.faces.push_back(std::vector{k, (k + 1) % n, n});
  return cone;
}

std::vector<Index> curve_indices(Index n) {
  std::vector<Index> loop;
  for (Index k = 0; k < n; ++k) loop.push_back(k);
  return loop;
}

FlatLoop flat(const Mesh& cone) {
  return flatten_loop(shapes::cube(), cone, curve_indices(cone.vertex_count() - 1));
}

TEST(FlatLoop, IsTheProjectionAlongItsArea) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    SCOPED_TRACE(curve.name);
    const FlatLoop loop = flat(cone_over(curve.points));
    EXPECT_FALSE(loop.smoothed);
    EXPECT_NEAR(loop.axis.norm(), 1, 1e-12);
    EXPECT_NEAR(loop.first_axis.norm(), 1, 1e-12);
    EXPECT_NEAR(loop.axis.dot(loop.first_axis), 0, 1e-12);
    EXPECT_GT(loop.axis.z(), 0.5);  // towards the source
    // Each vertex lies above its point of the outline, so that point has distance 0.
    const Eigen::RowVector3d second = loop.axis.cross(loop.first_axis);
    for (Index k = 0; k < curve.size(); ++k) {
      const Eigen::RowVector3d p = curve.points.row(loop.vertices[k]) - loop.centre;
      EXPECT_NEAR(loop.outline.signed_distance({p.dot(loop.first_axis), p.dot(second)}), 0, 1e-12);
    }
    EXPECT_LE(loop.outline.length(), LoopCurve(curve.points).length() + 1e-12);
    if (curve.points.col(2).maxCoeff() == curve.points.col(2).minCoeff()) {
      EXPECT_NEAR(loop.outline.length(), LoopCurve(curve.points).length(),
                  1e-12);  // a flat loop keeps its shape
    }
  }
}

TEST(FlatLoop, KeepsTheNormOfTheArea) {
  for (const test::ClosedCurve& curve : test::closed_curves()) {
    Eigen::RowVector3d area = Eigen::RowVector3d::Zero();
    for (Index k = 0; k < curve.size(); ++k)
      area += curve.points.row(k).cross(curve.points.row((k + 1) % curve.size())) / 2;
    EXPECT_NEAR(std::pow(flat(cone_over(curve.points)).outline.width(), 2), area.norm(), 1e-10) << curve.name;
  }
}

TEST(FlatLoop, DoesNotDependOnThePose) {
  for (const test::ClosedCurve& curve : test::closed_curves())
    for (const Eigen::Affine3d& map : test::similarities()) {
      SCOPED_TRACE(curve.name);
      const double scale = std::cbrt(map.linear().determinant());
      Mesh cone = cone_over(curve.points);
      const FlatLoop one = flat(cone);
      cone.positions = test::mapped(cone.positions, map);
      const FlatLoop other = flat(cone);
      EXPECT_NEAR(other.outline.length(), scale * one.outline.length(), 1e-9 * other.outline.length());
      EXPECT_NEAR(other.outline.width(), scale * one.outline.width(), 1e-9 * other.outline.width());
      EXPECT_NEAR(other.outline.reach(), scale * one.outline.reach(), 1e-9 * other.outline.reach());
      EXPECT_LT((other.axis.transpose() - map.linear() * one.axis.transpose() / scale).norm(), 1e-9);
      EXPECT_LT((other.centre.transpose() - map * Eigen::Vector3d(one.centre.transpose())).norm(),
                1e-9 * (1 + 50));
    }
}

TEST(FlatLoop, StartsAtTheFirstVertexListedInEitherDirection) {
  const Mesh cone = cone_over(test::closed_curves()[7].points);
  const Index n = cone.vertex_count() - 1;
  std::vector<Index> listed = curve_indices(n);
  std::rotate(listed.begin(), listed.begin() + 4, listed.end());
  const FlatLoop one = flatten_loop(shapes::cube(), cone, listed);
  EXPECT_EQ(one.vertices, listed);
  std::reverse(listed.begin() + 1, listed.end());
  EXPECT_EQ(flatten_loop(shapes::cube(), cone, listed).vertices, one.vertices);
}

TEST(FlatLoop, IsReversedForASourceThatWillBeTurnedOver) {
  // Closed apart from a small hole, so that it clearly encloses a volume, seen from inside.
  Mesh inward;
  inward.positions = shapes::cube().positions;
  const Mesh cube = shapes::cube();
  for (Index f = 1; f < cube.face_count(); ++f) {
    std::vector<Index> face(cube.faces[f].rbegin(), cube.faces[f].rend());
    inward.faces.push_back(face);
  }
  const std::vector<Index> loop = boundary_loops(inward).at(0);
  const FlatLoop turned = flatten_loop(cube, inward, loop);
  EXPECT_EQ(turned.vertices, std::vector<Index>(loop.rbegin(), loop.rend()));
  EXPECT_GT(turned.axis.z(), 0.9);  // towards the source, which stands on the missing face z = 0
}

TEST(FlatLoop, ThatCrossesItselfIsSmoothedToTheSameWidth) {
  for (const int count : {16, 41}) {
    Points curve = test::closed_curves()[2].points;
    curve = test::around_z(count, [](double) { return Eigen::Vector2d(1, 0); });
    curve.row(3).swap(curve.row(4));
    const FlatLoop loop = flat(cone_over(curve));
    EXPECT_TRUE(loop.smoothed);
    Eigen::RowVector3d area = Eigen::RowVector3d::Zero();
    for (int k = 0; k < count; ++k) area += curve.row(k).cross(curve.row((k + 1) % count)) / 2;
    EXPECT_NEAR(std::pow(loop.outline.width(), 2), area.norm(), 1e-9);
  }
}

TEST(FlatLoop, WithoutAreaIsRefused) {
  Points eight = test::around_z(20, [](double) { return Eigen::Vector2d(1, 0); });
  for (int k = 0; k < 20; ++k)
    eight.row(k) << std::sin(0.1 * std::numbers::pi * k), std::sin(0.2 * std::numbers::pi * k), 0;
  EXPECT_THROW(flat(cone_over(eight)), Error);
  EXPECT_THROW(flatten_loop(shapes::cube(), cone_over(eight), {0, 1, 2}), Error);  // not the whole loop
}

}  // namespace
}  // namespace meshgraft
