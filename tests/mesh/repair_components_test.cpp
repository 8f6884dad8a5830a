#include <algorithm>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/repair/repair_surface.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context no_context;

Mesh mesh_of(const test::TestMesh& family) { return make_mesh(family.positions, family.triangles); }

TEST(ComponentsOf, AgreeWithThoseOfVertices) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = test::both(mesh_of(family), mesh_of(test::tetrahedron()));
    const RepairSurface surface(mesh, no_context);
    const ConnectedComponents components = components_of(surface);
    const std::vector<Index> of_vertex = connected_components(mesh);
    ASSERT_EQ(components.faces.size(), 2);
    EXPECT_EQ(components.faces[1], 4);
    double area = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      EXPECT_EQ(components.of_face[f], of_vertex[mesh.faces[f][0]]);
      area += surface.face_area(f);
    }
    EXPECT_NEAR(components.area[0] + components.area[1], area, 1e-12 * area);
  }
}

TEST(RemoveDuplicateShells, KeepsOneOfSeveralCopies) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh once = mesh_of(family), thrice = test::both(once, test::both(once, once));
    RepairSurface one(once, no_context), three(thrice, no_context);
    EXPECT_FALSE(remove_duplicate_shells(one));
    EXPECT_TRUE(remove_duplicate_shells(three));
    EXPECT_EQ(three.faces().size(), once.face_count());
    EXPECT_FALSE(remove_duplicate_shells(three));
  }
}

TEST(RemoveDebris, RemovesWhatIsSmallInFacesAndArea) {
  const Mesh ball = mesh_of(test::icosphere(3));
  for (const auto& [size, removed] : {std::pair{0.001, true}, {0.1, true}, {1.0, false}}) {
    Mesh small = mesh_of(test::tetrahedron());
    small.positions *= size;
    const Mesh mesh = test::both(ball, small);
    RepairSurface surface(mesh, no_context);
    EXPECT_EQ(remove_debris(surface, 0.01), removed) << size;
    EXPECT_EQ(surface.faces().size(), ball.face_count() + (removed ? 0 : 4));
  }
}

}  // namespace
}  // namespace meshgraft
