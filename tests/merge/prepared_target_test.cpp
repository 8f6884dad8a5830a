#include "merge/prepared_target.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "merge/drop_scenes.h"

namespace meshgraft {
namespace {

TEST(SurfacePoint, OfAVertexIsTheVertex) {
  for (const test::TestMesh& mesh : test::small_families()) {
    const PreparedTarget target(test::shared_mesh(mesh), {});
    for (Index v = 0; v < mesh.size(); v += 7) {
      if (target.rings[v].empty()) {
        EXPECT_THROW(find_surface_point(target, {v}), Error) << mesh.name;
        continue;
      }
      const SurfacePoint point = find_surface_point(target, {v});
      EXPECT_EQ(point.point, mesh.positions.row(v)) << mesh.name;
      EXPECT_EQ(point.corners, std::vector<Index>{v});
    }
  }
}

TEST(SurfacePoint, IsTheNearestPointOfTheSurface) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const PreparedTarget target(test::shared_mesh(mesh), {});
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); t += 11) {
      const auto corner = [&](Eigen::Index face, int c) -> Eigen::RowVector3d {
        return mesh.positions.row(mesh.triangles(face, c));
      };
      const Eigen::RowVector3d on = 0.2 * corner(t, 0) + 0.5 * corner(t, 1) + 0.3 * corner(t, 2);
      EXPECT_LT((find_surface_point(target, {Eigen::Vector3d(on.transpose())}).point - on).norm(), 1e-12);
      const Eigen::RowVector3d off = on + 0.03 * mesh.box_diagonal() * Eigen::RowVector3d(0.6, -0.48, 0.64);
      const SurfacePoint found = find_surface_point(target, {Eigen::Vector3d(off.transpose())});
      double sampled = std::numeric_limits<double>::infinity();
      for (Eigen::Index face = 0; face < mesh.triangles.rows(); ++face)
        for (int i = 0; i <= 4; ++i)
          for (int j = 0; i + j <= 4; ++j) {
            const Eigen::RowVector3d q =
                (i * corner(face, 0) + j * corner(face, 1) + (4 - i - j) * corner(face, 2)) / 4;
            sampled = std::min(sampled, (q - off).norm());
          }
      EXPECT_LE((found.point - off).norm(), sampled + 1e-12);
      // The point lies in the triangle of its corners.
      ASSERT_EQ(found.corners.size(), 3U);
      Eigen::Matrix3d corners;
      for (int c = 0; c < 3; ++c) corners.col(c) = mesh.positions.row(found.corners[c]).transpose();
      Eigen::Matrix<double, 4, 3> system;
      system << corners, Eigen::RowVector3d::Ones();
      Eigen::Vector4d right;
      right << found.point.transpose(), 1;
      const Eigen::Vector3d weights = system.colPivHouseholderQr().solve(right);
      EXPECT_GT(weights.minCoeff(), -1e-9);
      EXPECT_LT((system * weights - right).norm(), 1e-9);
    }
  }
}

TEST(SurfacePoint, FarFromTheSurfaceIsRefused) {
  const test::TestMesh mesh = test::icosphere(2);
  const PreparedTarget target(test::shared_mesh(mesh), {});
  EXPECT_NO_THROW(find_surface_point(target, {Eigen::Vector3d(0, 0, 1.1)}));
  EXPECT_THROW(find_surface_point(target, {Eigen::Vector3d(0, 0, 1.5)}), Error);
  EXPECT_THROW(find_surface_point(target, {Eigen::Vector3d::Zero()}), Error);
}

TEST(Drops, WithNumbersOutOfRangeAreRefused) {
  const Mesh mesh = shapes::cube();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate({Index{7}, 0.5, -720}, mesh));
  for (const Drop& drop : {Drop{Index{8}}, Drop{Index{-1}}, Drop{Index{0}, 0.0}, Drop{Index{0}, -1.0},
                           Drop{Index{0}, nan}, Drop{Index{0}, {}, nan}, Drop{Eigen::Vector3d(0, nan, 0)}})
    EXPECT_THROW(validate(drop, mesh), Error);
}

TEST(MeanNormal, IsThatOfAPlaneAtAnyDistance) {
  const PreparedTarget target(test::shared_mesh(test::flat_sheet(10, 10)), {});
  for (const double distance : {0.0, 0.3, 100.0})
    EXPECT_LT(
        (mean_normal(target, find_surface_point(target, {Index{60}}), distance) - Eigen::RowVector3d::UnitZ())
            .norm(),
        1e-12);
}

TEST(MeanNormal, OfASphereIsRadialAndLocalWhereItGoesRightRound) {
  const test::TestMesh mesh = test::icosphere(3);
  const PreparedTarget target(test::shared_mesh(mesh), {});
  for (Index v = 0; v < mesh.size(); v += 60)
    for (const double distance : {0.0, 0.5, 1.0, 10.0}) {
      const SurfacePoint point = find_surface_point(target, {v});
      const Eigen::RowVector3d normal = mean_normal(target, point, distance);
      EXPECT_NEAR(normal.norm(), 1, 1e-12);
      EXPECT_GT(normal.dot(mesh.positions.row(v)), 0.99);
    }
}

}  // namespace
}  // namespace meshgraft
