#include "mesh/fans.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(FanCounts, AreOneOnManifoldsAndAddUpWhereTheyTouch) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const std::vector<Index> once = fan_counts(mesh, EdgeTable(mesh.vertex_count(), mesh.faces));
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      EXPECT_EQ(once[v], std::ranges::count(mesh.faces.corners(), v) > 0) << v;
    // A second copy shares one vertex with the first.
    const Index shared = mesh.faces.corners().back();
    Mesh twice = mesh;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      std::vector<Index> face(mesh.faces[f].begin(), mesh.faces[f].end());
      for (Index& v : face)
        if (v != shared) v += mesh.vertex_count();
      twice.faces.push_back(face);
    }
    twice.positions = mesh.positions.replicate(2, 1);
    const std::vector<Index> counts = fan_counts(twice, EdgeTable(twice.vertex_count(), twice.faces));
    for (Index v = 0; v < mesh.vertex_count(); ++v) EXPECT_EQ(counts[v], once[v] + (v == shared)) << v;
  }
}

TEST(ConsistentlyOriented, FailsAroundATurnedFace) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    for (const Index turned : {-1, 0}) {
      Triangles triangles = family.triangles;
      if (turned >= 0) std::swap(triangles(turned, 0), triangles(turned, 1));
      const Mesh mesh = make_mesh(family.positions, triangles);
      const EdgeTable table(mesh.vertex_count(), mesh.faces);
      for (Index e = 0; e < table.edge_count(); ++e) {
        const auto along = table.half_edges[e];
        const auto oriented = consistently_oriented(mesh, table, e);
        ASSERT_EQ(oriented.has_value(), along.size() == 2);
        if (oriented) {
          EXPECT_EQ(*oriented, along[0] / 3 != turned && along[1] / 3 != turned);
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
