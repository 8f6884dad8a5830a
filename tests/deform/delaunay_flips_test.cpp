#include "deform/proxy/delaunay_flips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Edge = std::array<Index, 2>;

/// Returns the corners opposite each edge.
std::map<Edge, std::vector<Index>> corners_opposite(const Triangles& triangles) {
  std::map<Edge, std::vector<Index>> opposite;
  for (const auto& t : triangles.rowwise())
    for (int c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax({t[c], t[(c + 1) % 3]});
      opposite[{a, b}].push_back(t[(c + 2) % 3]);
    }
  return opposite;
}

double angle_at(const Points& points, Index apex, Index a, Index b) {
  const Eigen::Vector3d u = points.row(a) - points.row(apex), v = points.row(b) - points.row(apex);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Returns the largest sum of the angles opposite an inner edge, minus 180°, in radians.
double worst_excess(const Points& points, const Triangles& triangles) {
  double worst = -10;
  for (const auto& [edge, corners] : corners_opposite(triangles)) {
    if (corners.size() != 2) continue;
    const double sum =
        angle_at(points, corners[0], edge[0], edge[1]) + angle_at(points, corners[1], edge[0], edge[1]);
    worst = std::max(worst, sum - std::numbers::pi);
  }
  return worst;
}

double area_of(const Points& points, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles.rowwise()) {
    const Eigen::RowVector3d u = points.row(t[1]) - points.row(t[0]), v = points.row(t[2]) - points.row(t[0]);
    sum += u.cross(v).norm() / 2;
  }
  return sum;
}

/// Returns plane triangulations in which many edges are not Delaunay: sheared sheets with jitter.
std::vector<test::TestMesh> plane_sheets() {
  std::vector<test::TestMesh> sheets;
  for (const double shear : {0.0, 0.7, 2.5}) {
    test::TestMesh sheet = test::flat_sheet(14, 10);
    sheet.positions.col(0) += shear * sheet.positions.col(1);
    sheets.push_back(sheet);
    sheets.push_back(test::transformed(
        sheet, Eigen::Affine3d(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized())), ", turned"));
  }
  sheets.push_back(test::minute(sheets[2]));
  return sheets;
}

TEST(DelaunayFlips, InAPlaneEndWithEveryInnerEdgeDelaunay) {
  bool any = false;
  for (const test::TestMesh& sheet : plane_sheets()) {
    SCOPED_TRACE(sheet.name);
    Triangles triangles = sheet.triangles;
    any |= worst_excess(sheet.positions, triangles) > 0.1;
    flip_to_delaunay(sheet.positions, triangles);
    EXPECT_LT(worst_excess(sheet.positions, triangles), 1e-8);
    EXPECT_NEAR(area_of(sheet.positions, triangles), area_of(sheet.positions, sheet.triangles),
                1e-12 * area_of(sheet.positions, triangles));
  }
  EXPECT_TRUE(any);
}

TEST(DelaunayFlips, KeepVerticesTopologyAndBoundary) {
  std::vector<test::TestMesh> meshes = test::mesh_families(), sheets = plane_sheets();
  meshes.insert(meshes.end(), sheets.begin(), sheets.end());
  for (const test::TestMesh& mesh : meshes) {
    SCOPED_TRACE(mesh.name);
    Triangles triangles = mesh.triangles;
    flip_to_delaunay(mesh.positions, triangles);
    const Mesh before = make_mesh(mesh.positions, mesh.triangles), after = make_mesh(mesh.positions, triangles);
    const TopologySummary was = summarise_topology(before), is = summarise_topology(after);
    EXPECT_EQ(is.vertices, was.vertices);
    EXPECT_EQ(is.faces, was.faces);
    EXPECT_EQ(is.euler_characteristic, was.euler_characteristic);
    EXPECT_EQ(is.manifold, was.manifold);
    EXPECT_EQ(is.oriented, was.oriented);
    EXPECT_EQ(is.closed, was.closed);
    EXPECT_EQ(boundary_loops(after), boundary_loops(before));
  }
}

TEST(DelaunayFlips, NeverFoldTheSurface) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    Triangles triangles = mesh.triangles;
    flip_to_delaunay(mesh.positions, triangles);
    EXPECT_LT(area_of(mesh.positions, triangles), 1.05 * area_of(mesh.positions, mesh.triangles));
    EXPECT_GT(area_of(mesh.positions, triangles), 0.95 * area_of(mesh.positions, mesh.triangles));
  }
}

TEST(DelaunayFlips, LeaveADelaunayTriangulationAlone) {
  for (const test::TestMesh& sheet : plane_sheets()) {
    SCOPED_TRACE(sheet.name);
    Triangles once = sheet.triangles;
    flip_to_delaunay(sheet.positions, once);
    Triangles twice = once;
    flip_to_delaunay(sheet.positions, twice);
    EXPECT_EQ(twice, once);
  }
}

TEST(DelaunayFlips, LeaveEdgesOfThreeFacesAndOpposedFacesAlone) {
  Points points(5, 3);
  points << 0, 0, 0, 10, 0, 0, 5, 1, 0, 5, -1, 0, 5, 0, 1;  // the edge 0–1 is far from Delaunay
  Triangles fin(3, 3), opposed(2, 3), pair(2, 3);
  fin << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  opposed << 0, 1, 2, 0, 1, 3;
  pair << 0, 1, 2, 1, 0, 3;
  Triangles flipped = fin;
  flip_to_delaunay(points, flipped);
  EXPECT_EQ(flipped, fin);
  flipped = opposed;
  flip_to_delaunay(points, flipped);
  EXPECT_EQ(flipped, opposed);
  flipped = pair;
  flip_to_delaunay(points, flipped);
  EXPECT_FALSE(corners_opposite(flipped).contains({0, 1}));
  EXPECT_TRUE(corners_opposite(flipped).contains({2, 3}));
}

}  // namespace
}  // namespace meshgraft
