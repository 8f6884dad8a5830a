#include "mesh/repair/hole_refinement.h"

#include <cmath>

#include <gtest/gtest.h>

#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// Returns the mesh without the faces that have a vertex within the radius of a point.
Mesh with_hole(const test::TestMesh& family, const Eigen::RowVector3d& centre, double radius) {
  Mesh mesh;
  mesh.positions = family.positions;
  for (Eigen::Index t = 0; t < family.triangles.rows(); ++t) {
    const std::array<Index, 3> face{family.triangles(t, 0), family.triangles(t, 1), family.triangles(t, 2)};
    bool near = false;
    for (const Index v : face) near |= (mesh.positions.row(v) - centre).norm() < radius;
    if (!near) mesh.faces.push_back(face);
  }
  return mesh;
}

Mesh filled(const Mesh& mesh, HoleFill how) { return repair(mesh, {.hole_edges = 60, .hole_fill = how}).mesh; }

double farthest_from_sphere(const Mesh& mesh) {
  double farthest = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Index v : mesh.faces[f]) centre += mesh.positions.row(v) / 3;
    farthest = std::max(farthest, std::abs(centre.norm() - 1));
  }
  return farthest;
}

const Eigen::RowVector3d pole(0, 0, 1);

TEST(HoleRefinement, MakesEdgesAsLongAsAround) {
  const Mesh open = with_hole(test::icosphere(3), pole, 0.5);
  const Index given = with_hole(test::icosphere(3), pole, 0.5).face_count();
  for (const HoleFill how : {HoleFill::refined, HoleFill::faired}) {
    const Mesh mesh = filled(open, how);
    const TopologySummary topology = summarise_topology(mesh);
    EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented);
    double around = 0, within = 0;
    for (Index f = 0; f < mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        const double length =
            (mesh.positions.row(mesh.faces[f][k]) - mesh.positions.row(mesh.faces[f][(k + 1) % 3])).norm();
        (f < given ? around : within) += length / (3 * (f < given ? given : mesh.face_count() - given));
      }
    EXPECT_GT(within, 0.6 * around);
    EXPECT_LT(within, 1.5 * around);
  }
}

TEST(HoleRefinement, LeavesTheSurfaceAroundAsItIs) {
  const Mesh open = with_hole(test::icosphere(3), pole, 0.5);
  const RepairResult result = repair(open, {.hole_edges = 60, .hole_fill = HoleFill::faired});
  for (Index v = 0; v < result.mesh.vertex_count(); ++v)
    if (const Index old = result.vertex_origin[v]; old >= 0) {
      EXPECT_EQ(result.mesh.positions.row(v), open.positions.row(old));
    }
  EXPECT_FALSE(repair(result.mesh, {.hole_edges = 60, .hole_fill = HoleFill::faired}).changed());
}

TEST(HoleRefinement, GoesOnAsASphere) {
  const Mesh open = with_hole(test::icosphere(3), pole, 0.5);
  const double plain = farthest_from_sphere(filled(open, HoleFill::plain));
  const double faired = farthest_from_sphere(filled(open, HoleFill::faired));
  EXPECT_LT(faired, 0.2 * plain) << faired << " beside " << plain;
}

TEST(HoleRefinement, StaysInAPlane) {
  const test::TestMesh sheet = test::flat_sheet(20, 20);
  const Eigen::RowVector3d centre =
      (sheet.positions.colwise().maxCoeff() + sheet.positions.colwise().minCoeff()) / 2;
  const Mesh open = with_hole(sheet, centre, 0.25 * sheet.box_diagonal());
  const Mesh mesh = filled(open, HoleFill::faired);
  EXPECT_GT(mesh.face_count(), open.face_count());
  EXPECT_LT(mesh.positions.col(2).cwiseAbs().maxCoeff(), 1e-12 * sheet.box_diagonal());
}

TEST(HoleRefinement, InterpolatesAttributes) {
  Mesh open = with_hole(test::icosphere(3), pole, 0.5);
  Attribute height{.name = "height"};
  for (Index v = 0; v < open.vertex_count(); ++v) height.values.push_back(open.positions(v, 2));
  double low = 1;
  const std::vector<Index> loop = boundary_loops(open).front();
  for (const Index v : loop) low = std::min(low, open.positions(v, 2));
  open.attributes = {height};
  const RepairResult result = repair(open, {.hole_edges = 60, .hole_fill = HoleFill::refined});
  for (Index v = 0; v < result.mesh.vertex_count(); ++v)
    if (result.vertex_origin[v] < 0) {
      EXPECT_GE(result.mesh.attributes[0].values[v], low - 1e-12);
      EXPECT_LE(result.mesh.attributes[0].values[v], 1);
    }
}

}  // namespace
}  // namespace meshgraft
