#include "merge/placement.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "merge/drop_scenes.h"

namespace meshgraft {
namespace {

std::vector<Eigen::RowVector3d> directions() {
  std::mt19937 random(31);
  const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; };
  std::vector<Eigen::RowVector3d> found{Eigen::RowVector3d::UnitX(), Eigen::RowVector3d::UnitZ()};
  for (int k = 0; k < 8; ++k) found.push_back(Eigen::RowVector3d(number(), number(), number()).normalized());
  return found;
}

TEST(Turned, IsTheSmallestRotationFromOneDirectionToTheOther) {
  for (const Eigen::RowVector3d& from : directions())
    for (const Eigen::RowVector3d& to : directions()) {
      EXPECT_LT((turned(from, from, to) - to).norm(), 1e-12);
      const Eigen::RowVector3d axis = from.cross(to);
      EXPECT_LT((turned(axis, from, to) - axis).norm(), 1e-12);  // what is across both stays
      for (const Eigen::RowVector3d& v : directions()) {
        EXPECT_NEAR(turned(v, from, to).norm(), v.norm(), 1e-12);
        EXPECT_NEAR(turned(v, from, to).dot(to), v.dot(from), 1e-12);
        EXPECT_LT((turned(turned(v, from, to), to, from) - v).norm(), 1e-12);
      }
    }
}

TEST(Placement, MapTakesTheLoopsFrameToItsPlace) {
  for (FlatLoop loop : test::flat_loops())
    for (const Eigen::RowVector3d& normal : directions())
      for (const double size : {0.01, 1.0, 30.0}) {
        loop.centre << 1, -2, 0.5;
        const Placement placement{normal, normal.transpose().unitOrthogonal().transpose()};
        const Eigen::RowVector3d centre(4, 5, 6);
        const Eigen::Affine3d map = placement_map(loop, placement, size, centre);
        EXPECT_LT((map * Eigen::Vector3d(loop.centre.transpose()) - centre.transpose()).norm(), 1e-12);
        EXPECT_LT((map.linear() * loop.axis.transpose() - size * normal.transpose()).norm(), 1e-12 * size);
        EXPECT_LT((map.linear() * loop.first_axis.transpose() - size * placement.first_axis.transpose()).norm(),
                  1e-12 * size);
        const Eigen::Matrix3d rotation = map.linear() / size;
        EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_GT(rotation.determinant(), 0);
      }
}

TEST(Placement, SpinsAboutTheSurfacesNormal) {
  for (const test::TestMesh& mesh : {test::icosphere(2), test::flat_sheet(12, 12), test::torus(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const PreparedTarget target(test::shared_mesh(mesh), {});
    const FlatLoop loop = test::flat_loops()[0];
    const SurfacePoint point = find_surface_point(target, {mesh.size() / 2});
    const Placement still = place_outline(target, point, loop, 0.5, 0);
    EXPECT_NEAR(still.normal.dot(still.first_axis), 0, 1e-12);
    EXPECT_LT((still.first_axis - turned(loop.first_axis, loop.axis, still.normal)).norm(), 1e-12);
    for (const double spin : {-90.0, 30.0, 180.0, 750.0}) {
      const Placement spun = place_outline(target, point, loop, 0.5, spin);
      const double angle = spin * std::numbers::pi / 180;
      EXPECT_EQ(spun.normal, still.normal);
      const Eigen::RowVector3d expected =
          std::cos(angle) * still.first_axis + std::sin(angle) * still.normal.cross(still.first_axis);
      EXPECT_LT((spun.first_axis - expected).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace meshgraft
