#include "mesh/closed_components.h"

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/winding.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

std::vector<Index> inward_of(const Mesh& mesh) {
  return inward_components(mesh, EdgeTable(mesh.vertex_count(), mesh.faces)).components;
}

TEST(InwardComponents, AreTheClosedOnesThatWereTurnedOver) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    EXPECT_EQ(inward_of(mesh), std::vector<Index>{});
    EXPECT_EQ(inward_of(turned_over(mesh)).size(), summarise_topology(mesh).closed ? 1 : 0);
  }
}

TEST(InwardComponents, LeaveOutTheWallsOfCavities) {
  for (const double size : {0.1, 0.5, 2.0}) {
    const test::TestMesh ball = test::icosphere(2);
    const Mesh outer = make_mesh(ball.positions, ball.triangles);
    Mesh inner = turned_over(outer);
    inner.positions *= size;
    EXPECT_EQ(inward_of(test::both(outer, inner)).empty(), size < 1) << size;
    inner.positions.rowwise() += Eigen::RowVector3d(5, 0, 0);
    EXPECT_EQ(inward_of(test::both(outer, inner)), std::vector<Index>{outer.vertex_count()}) << size;
  }
}

}  // namespace
}  // namespace meshgraft
