#include "mesh/area_vector.h"

#include <numbers>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(AreaVector, SumsToNothingOverClosedSurfaces) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    if (!summarise_topology(make_mesh(family.positions, family.triangles)).closed) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double area = 0;
    for (Eigen::Index t = 0; t < family.triangles.rows(); ++t) {
      const Eigen::Vector3d twice = area_vector(family.triangles, t, family.positions);
      sum += twice;
      area += twice.norm();
    }
    EXPECT_GT(area, 0);
    // Coordinates near 1e9 are rounded to 1e-7, and so are the triangles' corners.
    EXPECT_LT(sum.norm(),
              1e-12 * area + 1e-6 * std::sqrt(area) * (family.positions.cwiseAbs().maxCoeff() > 1e6));
  }
}

TEST(AreaVector, OfAPolygonIsTheSumOfItsTriangles) {
  const Mesh mesh = shapes::torus(9, 7);
  const Triangulation pieces = triangulate(mesh);
  std::vector<Eigen::Vector3d> rest;
  for (Index f = 0; f < mesh.face_count(); ++f) rest.push_back(area_vector(mesh.faces[f], mesh.positions));
  for (Eigen::Index t = 0; t < pieces.triangles.rows(); ++t)
    rest[pieces.face[t]] -= area_vector(pieces.triangles, t, mesh.positions);
  for (const Eigen::Vector3d& left : rest) EXPECT_LT(left.norm(), 1e-14);
}

TEST(ClampedCotangent, IsThatOfTheAngleUpToALimit) {
  const Eigen::Vector3d apex(1, 2, 3), along(2, 0, 0);
  for (int degrees = 1; degrees < 180; ++degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d other(std::cos(angle), 0, std::sin(angle));
    EXPECT_NEAR(clamped_cotangent(apex, apex + along, apex + other), 1 / std::tan(angle), 1e-12);
  }
  EXPECT_EQ(clamped_cotangent(apex, apex + along, apex + along), 1000);
  EXPECT_EQ(clamped_cotangent(apex, apex + along, apex - along + Eigen::Vector3d(0, 1e-6, 0)), -1000);
}

}  // namespace
}  // namespace meshgraft
