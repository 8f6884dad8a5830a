#include <algorithm>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/repair/repair_surface.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context fill_context;

TEST(FillHoles, ClosesWhatWasOpened) {
  for (const test::TestMesh& family : test::mesh_families()) {
    const Mesh clean = make_mesh(family.positions, family.triangles);
    if (family.triangles.rows() < 200 || !summarise_topology(clean).closed) continue;
    SCOPED_TRACE(family.name);
    const Mesh open = test::without_faces(clean, 2, 1, 1);
    RepairSurface whole(clean, fill_context), surface(open, fill_context);
    EXPECT_FALSE(fill_holes(whole, {.hole_edges = 100}));
    EXPECT_TRUE(fill_holes(surface, {.hole_edges = 100}));
    EXPECT_TRUE(summarise_topology(surface.mesh()).closed);
    EXPECT_TRUE(summarise_topology(surface.mesh()).oriented);
    for (Index f = 0; f < surface.faces().size(); ++f)
      EXPECT_EQ(surface.traced().is_new[f], f >= open.face_count());
  }
}

TEST(FillHoles, LeavesHolesOfMoreEdges) {
  const test::TestMesh tube = test::tube(12, 5);
  const Mesh open = make_mesh(tube.positions, tube.triangles);
  for (const Index most : {11, 12}) {
    RepairSurface surface(open, fill_context);
    EXPECT_EQ(fill_holes(surface, {.hole_edges = most}), most == 12);
    EXPECT_EQ(boundary_loops(surface.mesh()).size(), most == 12 ? 0 : 2);
  }
}

}  // namespace
}  // namespace meshgraft
