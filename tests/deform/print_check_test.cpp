#include "deform/measure/print_check.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/winding.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Eigen::Vector3d;

Mesh made_of(const test::TestMesh& family) { return make_mesh(family.positions, family.triangles); }

/// A box of 1 × 1 × 3, mapped.
Mesh box(const Eigen::Affine3d& map = Eigen::Affine3d::Identity()) {
  return made_of(test::transformed(test::bar(4, 12), map, ""));
}

Eigen::Affine3d scaled(const Vector3d& by) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.scale(by);
  return map;
}

Eigen::Affine3d tilted(double angle_deg) {
  return Eigen::Affine3d(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180, Vector3d::UnitX()));
}

TEST(PrintCheck, MeasuresABox) {
  const PrintCheck check = check_print(box());
  EXPECT_LT((check.size - Vector3d(1, 1, 3)).norm(), 1e-12);
  EXPECT_NEAR(check.area, 14, 1e-12);
  ASSERT_TRUE(check.volume);
  EXPECT_NEAR(*check.volume, 3, 1e-12);
  EXPECT_FALSE(check.inside_out);
  EXPECT_EQ(check.holes, 0);
  EXPECT_TRUE(check.open_edges.empty() && check.non_manifold_edges.empty() && check.turned_edges.empty());
  EXPECT_TRUE(check.intersections.empty());
  ASSERT_TRUE(check.thinnest_wall);
  EXPECT_NEAR(*check.thinnest_wall, 1, 1e-4);
  EXPECT_TRUE(check.overhanging.empty()) << "it stands on the bed";
}

TEST(PrintCheck, FindsDownwardFacesBeyondTheAngle) {
  const PrintCheck steep = check_print(box(tilted(30)));
  EXPECT_NEAR(steep.overhang_area, 1, 1e-9) << "the foot, at 60 degrees from the vertical";
  const PrintCheck low = check_print(box(tilted(60)));
  EXPECT_NEAR(low.overhang_area, 3, 1e-9) << "the long side";
  EXPECT_NEAR(check_print(box(tilted(60)), {.overhang_deg = 25}).overhang_area, 4, 1e-9);
  EXPECT_EQ(check_print(box(tilted(60)), {.overhang_deg = 65}).overhang_area, 0);
  EXPECT_EQ(check_print(box(tilted(60)), {.up = tilted(60) * Vector3d::UnitZ()}).overhang_area, 0);
}

/// Towards the edge of a wedge, the thickness tells only how small the faces are.
TEST(PrintCheck, TakesNoEdgeForAWall) {
  Points points(6, 3);
  points << 0, 0, 0, 0, 1, 0, 1, 0, 0.1, 1, 1, 0.1, 1, 0, -0.1, 1, 1, -0.1;
  Triangles triangles(8, 3);
  triangles << 0, 2, 3, 0, 3, 1, 0, 5, 4, 0, 1, 5, 2, 4, 5, 2, 5, 3, 0, 4, 2, 1, 3, 5;
  const PrintCheck check = check_print(make_mesh(points, triangles));
  ASSERT_TRUE(check.volume);
  EXPECT_NEAR(*check.volume, 0.1, 1e-12);
  ASSERT_TRUE(check.thinnest_wall);
  EXPECT_NEAR(*check.thinnest_wall, 1, 1e-4) << "between the ends of the wedge";
}

TEST(PrintCheck, FindsThinWalls) {
  const Mesh plate = box(scaled({0.05, 1, 1}));
  const PrintCheck check = check_print(plate, {.least_wall = 0.1});
  ASSERT_TRUE(check.thinnest_wall);
  EXPECT_NEAR(*check.thinnest_wall, 0.05, 1e-4);
  double area = 0;
  for (const Index t : check.thin) {
    const auto corner = [&](int c) { return plate.positions.row(check.surface.triangles(t, c)); };
    const Eigen::RowVector3d a = corner(1) - corner(0), b = corner(2) - corner(0);
    EXPECT_NEAR(std::abs(a.cross(b).normalized().x()), 1, 1e-9) << "a large side";
    area += a.cross(b).norm() / 2;
  }
  EXPECT_NEAR(area, 6, 1e-9);
  EXPECT_EQ(check_print(plate, {.least_wall = 0.04}).thin, check.thin) << "the thinnest places";
  EXPECT_EQ(check_print(plate).thin, check.thin);
  EXPECT_GT(check_print(plate, {.least_wall = 1.01}).thin.size(), check.thin.size());
}

TEST(PrintCheck, HasNoVolumeWhereItIsOpen) {
  const Mesh open = test::without_faces(box(), 1, 0, 3);
  const PrintCheck check = check_print(open);
  EXPECT_FALSE(check.volume);
  EXPECT_EQ(check.holes, 1);
  EXPECT_EQ(check.open_edges.size(), 3u);
  EXPECT_FALSE(check_print(test::with_fins(box(), 1, 3)).volume);
  EXPECT_FALSE(check_print(test::with_fins(box(), 1, 3)).non_manifold_edges.empty());
  const PrintCheck turned = check_print(test::with_turned_patches(box(), 1, 1, 3));
  EXPECT_FALSE(turned.volume);
  EXPECT_FALSE(turned.turned_edges.empty());
}

TEST(PrintCheck, TellsWhatIsInsideOut) {
  const PrintCheck check = check_print(turned_over(box(tilted(60))));
  EXPECT_TRUE(check.inside_out);
  EXPECT_NEAR(check.volume.value_or(0), 3, 1e-12);
  EXPECT_NEAR(check.thinnest_wall.value_or(0), 1, 1e-4);
  EXPECT_NEAR(check.overhang_area, 3, 1e-9) << "of the faces as they should be";
}

TEST(PrintCheck, FindsTheIntersectionsOfPieces) {
  const Mesh crossing = test::both(box(), box(Eigen::Affine3d(Eigen::Translation3d(0.51, 0.52, 1.03))));
  const PrintCheck check = check_print(crossing);
  std::vector<Index> all(static_cast<std::size_t>(crossing.vertex_count()));
  std::iota(all.begin(), all.end(), Index{0});
  EXPECT_FALSE(check.intersections.empty());
  EXPECT_EQ(static_cast<std::int64_t>(check.intersections.size()),
            count_self_intersections(crossing.positions, check.surface.triangles, all));
}

// A rigid motion of the surface and of the direction up changes neither volume, walls nor overhangs; scale acts
// by its power.
TEST(PrintCheck, FollowsSimilarities) {
  const Eigen::Affine3d map = Eigen::Translation3d(30, -20, 7) *
                              Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()) * Eigen::Scaling(2.5);
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const PrintCheck before = check_print(made_of(family));
    const PrintCheck after =
        check_print(made_of(test::transformed(family, map, "")), {.up = map.linear() * Vector3d::UnitZ()});
    EXPECT_EQ(after.volume.has_value(), before.volume.has_value());
    EXPECT_NEAR(after.volume.value_or(0), 15.625 * before.volume.value_or(0),
                1e-8 * (1 + before.volume.value_or(0)));
    EXPECT_NEAR(after.area, 6.25 * before.area, 1e-8 * before.area);
    EXPECT_EQ(after.thinnest_wall.has_value(), before.thinnest_wall.has_value());
    EXPECT_EQ(after.holes, before.holes);
    EXPECT_EQ(after.open_edges, before.open_edges);
  }
}

TEST(PrintCheck, LeavesOutFacesWithoutFiniteCoordinates) {
  EXPECT_TRUE(check_print(Mesh{}).size.isZero());
  const PrintCheck check = check_print(test::with_non_finite(box(), 2, 3));
  EXPECT_TRUE(check.size.allFinite());
  EXPECT_LT(check.surface.triangles.rows(), box().face_count());
  EXPECT_FALSE(check.open_edges.empty());
  EXPECT_FALSE(check.volume.has_value());
}

}  // namespace
}  // namespace meshgraft
