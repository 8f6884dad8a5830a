#include "mesh/repair/repair_surface.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context no_limits;

TEST(RepairSurface, WithoutChangesIsTheGivenMesh) {
  for (const test::TestMesh& family : test::small_families()) {
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const RepairResult result = RepairSurface(mesh, no_limits).finish(false);
    EXPECT_EQ(result.mesh.positions, mesh.positions);
    EXPECT_EQ(result.mesh.faces, mesh.faces);
    EXPECT_FALSE(result.changed());
  }
}

TEST(RepairSurface, KnowsTheOriginOfAllElements) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    RepairSurface surface(mesh, no_limits);
    Flags every_third(mesh.face_count(), 0);
    for (Index f = 0; f < mesh.face_count(); f += 3) every_third[f] = 1;
    surface.report_faces(RepairChangeKind::removed_duplicate_face, every_third);
    surface.remove_faces(every_third);
    const RepairResult result = surface.finish(true);
    ASSERT_EQ(result.mesh.face_count(), mesh.face_count() - (mesh.face_count() + 2) / 3);
    for (Index f = 0; f < result.mesh.face_count(); ++f) {
      const Index origin = result.face_origin[f];
      EXPECT_NE(origin % 3, 0);
      EXPECT_EQ(result.face.new_index[origin], f);
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(result.vertex_origin[result.mesh.faces[f][k]], mesh.faces[origin][k]);
    }
    for (Index v = 0; v < result.mesh.vertex_count(); ++v) {
      EXPECT_EQ(result.vertex.new_index[result.vertex_origin[v]], v);
      EXPECT_EQ(result.mesh.positions.row(v), mesh.positions.row(result.vertex_origin[v]));
    }
  }
}

TEST(ShortestEdges, AreThoseAtEachVertex) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const std::vector<double> shortest = shortest_edges(RepairSurface(mesh, no_limits));
    std::vector<double> expected(mesh.vertex_count(), std::numeric_limits<double>::infinity());
    for (Eigen::Index t = 0; t < family.triangles.rows(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Index a = family.triangles(t, k), b = family.triangles(t, (k + 1) % 3);
        const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
        expected[a] = std::min(expected[a], length);
        expected[b] = std::min(expected[b], length);
      }
    EXPECT_EQ(shortest, expected);
  }
}

}  // namespace
}  // namespace meshgraft
