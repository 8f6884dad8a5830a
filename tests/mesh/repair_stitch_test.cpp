#include <algorithm>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/repair/repair_surface.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context plain_context;

TEST(Stitch, MakesASurfaceOfASoup) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles), soup = test::as_soup(mesh);
    RepairSurface whole(mesh, plain_context), surface(soup, plain_context);
    EXPECT_FALSE(stitch(whole, {}));
    EXPECT_TRUE(stitch(surface, {}));
    EXPECT_EQ(surface.edges().edge_count(), whole.edges().edge_count());
    EXPECT_FALSE(stitch(surface, {}));
  }
}

TEST(Stitch, WeldsWithinTheDistanceAlone) {
  const test::TestMesh ball = test::icosphere(2);
  const Mesh clean = make_mesh(ball.positions, ball.triangles);
  const Mesh soup = test::with_noise(test::as_soup(clean), 1e-4, 1);
  for (const double distance : {1e-5, 2e-3}) {
    RepairSurface surface(soup, plain_context);
    EXPECT_EQ(weld_distance(surface, distance), distance);
    stitch(surface, distance);
    EXPECT_EQ(summarise_topology(surface.mesh()).closed, distance > 1e-4) << distance;
  }
}

TEST(SplitTJunctions, LetsEdgesRunFromVertexToVertex) {
  for (const test::TestMesh& family : test::small_families()) {
    if (family.triangles.rows() < 40) continue;
    SCOPED_TRACE(family.name);
    const Mesh clean = make_mesh(family.positions, family.triangles),
               torn = test::with_t_junctions(clean, 2, 1);
    RepairSurface whole(clean, plain_context), surface(torn, plain_context);
    EXPECT_FALSE(split_t_junctions(whole, {}));
    EXPECT_TRUE(split_t_junctions(surface, {}));
    stitch(surface, {});
    EXPECT_EQ(boundary_loops(surface.mesh()).size(), boundary_loops(clean).size());
    EXPECT_FALSE(split_t_junctions(surface, {}));
  }
}

}  // namespace
}  // namespace meshgraft
