// The intrinsic Delaunay triangulation, whose cotangents measure derivatives whatever the shape of triangles.
#include "operators/intrinsic_delaunay.h"

#include <array>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "operators/laplacian.h"
#include "support/density_cases.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

double area_of(const TestMesh& mesh) {
  double area = 0;
  for (const double a : vertex_areas(mesh.positions, mesh.triangles)) area += a;
  return area;
}

// The sum of w d² over the edges is the area, for the part of d along the axis and for the part around it.
TEST(IntrinsicDelaunay, MeasuresDerivativesHoweverTrianglesAreShaped) {
  for (const int rows : {20, 100, 200})
    for (const Diagonals diagonals : {Diagonals::rising, Diagonals::falling, Diagonals::shifted}) {
      const TestMesh mesh = tube_of_long_cells(48, {rows, rows}, diagonals).mesh;
      const IntrinsicEdges surface = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
      EXPECT_EQ(surface.differ, diagonals == Diagonals::shifted && rows > 60) << rows;
      double along = 0, around = 0;
      for (const auto& [ends, weight] : surface.edges) {
        const Eigen::RowVector3d d = mesh.positions.row(ends[0]) - mesh.positions.row(ends[1]);
        along += weight * d.z() * d.z();
        around += weight * d.head<2>().squaredNorm();
      }
      const double area = area_of(mesh);
      EXPECT_NEAR(along / area, 1, 0.02) << rows << ", " << to_string(diagonals);
      EXPECT_NEAR(around / area, 1, 0.05) << rows << ", " << to_string(diagonals);
    }
}

TEST(IntrinsicDelaunay, MeasuresDerivativesOnFansAndSlivers) {
  for (const OddCells odd : {OddCells::fans, OddCells::slivers}) {
    const TestMesh mesh = sheet_of_odd_cells(odd).mesh;
    const IntrinsicEdges surface = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
    EXPECT_TRUE(surface.differ);
    double along = 0, across = 0;
    for (const auto& [ends, weight] : surface.edges) {
      const Eigen::RowVector3d d = mesh.positions.row(ends[0]) - mesh.positions.row(ends[1]);
      along += weight * d.z() * d.z();
      across += weight * d.x() * d.x();
    }
    EXPECT_NEAR(along / area_of(mesh), 1, 0.02);
    EXPECT_NEAR(across / area_of(mesh), 1, 0.02);
  }
}

TEST(IntrinsicDelaunay, KeepsTheEdgesOfDelaunayTriangles) {
  const TestMesh mesh = icosphere(2);
  const IntrinsicEdges surface = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  EXPECT_FALSE(surface.differ);
  EXPECT_EQ(2 * surface.edges.size(), rings.values.size());
  const SparseRows K = dirichlet_matrix(mesh.size(), surface),
                   extrinsic = dirichlet_matrix(mesh.positions, mesh.triangles, rings);
  EXPECT_LT((K - extrinsic).norm(), 1e-12 * K.norm());
}

TEST(IntrinsicDelaunay, ConnectsEveryVertexWithBoundedWeights) {
  for (const TestMesh& mesh : mesh_families()) {
    const IntrinsicEdges surface = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
    Flags connected(mesh.size(), 0);
    std::array<Index, 2> previous{-1, -1};
    for (const auto& [ends, weight] : surface.edges) {
      EXPECT_LT(previous, ends) << mesh.name;
      EXPECT_GE(weight, 1e-3) << mesh.name;
      EXPECT_LE(weight, 16) << mesh.name;
      previous = ends;
      for (const Index v : ends) connected[v] = 1;
    }
    for (const Index v : mesh.triangles.reshaped()) EXPECT_TRUE(connected[v]) << mesh.name << ", vertex " << v;
    const SparseRows K = dirichlet_matrix(mesh.size(), surface);
    EXPECT_LT((K * Eigen::VectorXd::Ones(mesh.size())).norm(), 1e-12 * K.norm()) << mesh.name;
  }
}

}  // namespace
}  // namespace meshgraft::test
