#include "merge/exponential_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>

#include "merge/closed_curves.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A surface with a point, for maps around it.
struct ChartCase {
  test::TestMesh mesh;
  Points normals;
  IndexLists rings;
  ChartOrigin origin;

  explicit ChartCase(test::TestMesh family) : mesh(std::move(family)) {
    const IndexLists faces_at = vertex_triangles(mesh.size(), mesh.triangles);
    rings = vertex_rings(mesh.triangles, faces_at);
    normals = vertex_normals(mesh.positions, mesh.triangles, faces_at);
    start_at(mesh.size() / 2);
  }
  void start_at(Index v) {
    const Eigen::Vector3d normal = normals.row(v);
    origin = {mesh.positions.row(v), normal.transpose(), normal.unitOrthogonal().transpose(), {v}};
  }
  Eigen::RowVector3d second_axis() const { return origin.normal.cross(origin.first_axis); }
  PlanePoints map(double reach) const {
    return exponential_map(mesh.positions, normals, rings, origin, reach, {});
  }
};

TEST(ExponentialMap, OfAPlaneIsThePlane) {
  for (const Eigen::Affine3d& pose : test::similarities()) {
    ChartCase chart(test::transformed(test::flat_sheet(14, 10), pose, " posed"));
    const double size = chart.mesh.box_diagonal();
    for (const Index v : {0, 40, chart.mesh.size() / 2}) {
      chart.start_at(v);
      const PlanePoints uv = chart.map(10 * size);
      for (Index w = 0; w < chart.mesh.size(); ++w) {
        const Eigen::RowVector3d p = chart.mesh.positions.row(w) - chart.origin.point;
        const Eigen::RowVector2d expected(p.dot(chart.origin.first_axis), p.dot(chart.second_axis()));
        EXPECT_LT((uv.row(w) - expected).norm(), 1e-12 * size) << chart.mesh.name;
      }
    }
  }
}

TEST(ExponentialMap, MayStartWithinATriangle) {
  ChartCase chart(test::flat_sheet(14, 10));
  const auto corners = chart.mesh.triangles.row(chart.mesh.triangles.rows() / 2);
  chart.origin.seeds = {corners[0], corners[1], corners[2]};
  chart.origin.point = 0.5 * chart.mesh.positions.row(corners[0]) + 0.3 * chart.mesh.positions.row(corners[1]) +
                       0.2 * chart.mesh.positions.row(corners[2]);
  const PlanePoints uv = chart.map(10);
  for (Index w = 0; w < chart.mesh.size(); ++w)
    EXPECT_NEAR(uv.row(w).norm(), (chart.mesh.positions.row(w) - chart.origin.point).norm(), 1e-12);
}

TEST(ExponentialMap, KeepsTheDistancesOfItsSeedsAndOfTheNearestNeighbour) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::irregular_grid(22, 16), test::torus(14, 30)})
    for (Index v = 0; v < mesh.size(); v += 17) {
      ChartCase chart(mesh);
      chart.start_at(v);
      const auto distance = [&](Index w) { return (mesh.positions.row(w) - chart.origin.point).norm(); };
      const auto ring = chart.rings[v];
      const Index nearest = *std::min_element(ring.begin(), ring.end(),
                                              [&](Index a, Index b) { return distance(a) < distance(b); });
      const PlanePoints around_vertex = chart.map(1);
      EXPECT_NEAR(around_vertex.row(nearest).norm(), distance(nearest), 1e-12) << mesh.name;
      chart.origin.seeds = {v, nearest};
      chart.origin.point += 0.3 * (mesh.positions.row(nearest) - chart.origin.point);
      const PlanePoints around_point = chart.map(1);
      for (const Index seed : chart.origin.seeds)
        EXPECT_NEAR(around_point.row(seed).norm(), distance(seed), 1e-12) << mesh.name;
    }
}

TEST(ExponentialMap, UnrollsACylinderTheBetterTheFinerItIs) {
  double last = 1;
  for (const int around : {24, 48, 96}) {
    ChartCase chart(test::tube(around, around));
    constexpr double radius = 0.4;
    Index middle = 0;
    const double half = chart.mesh.positions.col(2).maxCoeff() / 2;
    for (Index v = 0; v < chart.mesh.size(); ++v)
      if (std::abs(chart.mesh.positions(v, 2) - half) < std::abs(chart.mesh.positions(middle, 2) - half))
        middle = v;
    chart.start_at(middle);
    chart.origin.normal = Eigen::RowVector3d(chart.origin.point.x(), chart.origin.point.y(), 0).normalized();
    chart.origin.first_axis = Eigen::RowVector3d::UnitZ();
    const double reach = radius;
    const PlanePoints uv = chart.map(reach);
    double worst = 0;
    for (Index w = 0; w < chart.mesh.size(); ++w) {
      if (!uv.row(w).allFinite()) continue;
      const Eigen::RowVector3d p = chart.mesh.positions.row(w);
      const double start = std::atan2(chart.origin.point.y(), chart.origin.point.x());
      const double angle = std::remainder(std::atan2(p.y(), p.x()) - start, 2 * std::numbers::pi);
      // The second axis, normal × z, runs against the angle.
      const Eigen::RowVector2d expected(p.z() - chart.origin.point.z(), -radius * angle);
      worst = std::max(worst, (uv.row(w) - expected).norm() / reach);
    }
    EXPECT_LT(worst, 0.5 * last) << around;
    last = worst;
  }
  EXPECT_LT(last, 0.01);
}

TEST(ExponentialMap, EndsAnEdgeBeyondItsReach) {
  for (const test::TestMesh& mesh :
       {test::bumpy_sphere(3), test::irregular_grid(22, 16), test::torus(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const ChartCase chart(mesh);
    const double reach = 0.15 * mesh.box_diagonal();
    const PlanePoints near = chart.map(reach), wide = chart.map(1.5 * reach);
    Index inside = 0;
    for (Index v = 0; v < mesh.size(); ++v) {
      if (!near.row(v).allFinite()) {
        EXPECT_FALSE(wide.row(v).norm() <= reach);  // farther, or NaN
        continue;
      }
      if (near.row(v).norm() > reach) {
        bool beside = false;
        for (const Index w : chart.rings[v]) beside = beside || near.row(w).norm() <= reach;
        EXPECT_TRUE(beside);
      } else {
        ++inside;
        EXPECT_EQ(near.row(v), wide.row(v));  // a larger reach changes nothing within
      }
    }
    EXPECT_GT(inside, 3);
    EXPECT_LT(inside, mesh.size());
  }
}

TEST(ExponentialMap, TurnsWithItsAxisAndNotWithTheSurface) {
  for (const test::TestMesh& mesh :
       {test::bumpy_sphere(3), test::irregular_grid(22, 16), test::torus(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    ChartCase chart(mesh);
    const double reach = 0.3 * mesh.box_diagonal();
    const PlanePoints uv = chart.map(reach);
    const auto differs = [](const PlanePoints& a, const PlanePoints& b) {
      double most = 0;
      for (Eigen::Index v = 0; v < a.rows(); ++v)
        if (a.row(v).allFinite()) most = std::max(most, (a.row(v) - b.row(v)).norm());
      return most;
    };
    constexpr double angle = 0.8;
    ChartCase spun = chart;
    spun.origin.first_axis = std::cos(angle) * chart.origin.first_axis + std::sin(angle) * chart.second_axis();
    const PlanePoints turned = uv * Eigen::Rotation2Dd(-angle).toRotationMatrix().transpose();
    EXPECT_LT(differs(turned, spun.map(reach)), 1e-10 * reach);
    for (const Eigen::Affine3d& pose : test::similarities()) {
      const double scale = std::cbrt(pose.linear().determinant());
      ChartCase moved(test::transformed(mesh, pose, " posed"));
      moved.origin.normal = chart.origin.normal * pose.linear().transpose() / scale;
      moved.origin.first_axis = chart.origin.first_axis * pose.linear().transpose() / scale;
      EXPECT_LT(differs(scale * uv, moved.map(scale * reach)), 1e-8 * scale * reach);
    }
  }
}

}  // namespace
}  // namespace meshgraft
