#include "mesh/coincident.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(CoincidentClasses, AreTheSmallestVerticesAtTheirPositions) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh soup = test::as_soup(make_mesh(family.positions, family.triangles));
    std::vector<Index> odd;
    for (Index v = 1; v < soup.vertex_count(); v += 2) odd.push_back(v);
    const std::vector<Index> classes = coincident_classes(soup.positions, odd);
    ASSERT_EQ(classes.size(), odd.size());
    for (std::size_t k = 0; k < odd.size(); ++k) {
      std::size_t first = 0;
      while (soup.positions.row(odd[first]) != soup.positions.row(odd[k])) ++first;
      EXPECT_EQ(classes[k], odd[first]);
    }
  }
}

TEST(BoundaryVertices, AreThoseOfTheBoundaryLoops) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    std::vector<Index> expected;
    for (const auto& loop : boundary_loops(mesh)) expected.insert(expected.end(), loop.begin(), loop.end());
    std::ranges::sort(expected);
    EXPECT_EQ(boundary_vertices(mesh.vertex_count(), EdgeTable(mesh.vertex_count(), mesh.faces)), expected);
  }
}

TEST(CoincidentBoundaryEdges, AreTheEdgesThatASoupHasLost) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles), soup = test::as_soup(mesh);
    std::vector<Index> all(soup.vertex_count());
    std::iota(all.begin(), all.end(), 0);
    const EdgeTable whole(mesh.vertex_count(), mesh.faces), torn(soup.vertex_count(), soup.faces);
    Index inner = 0;
    for (Index e = 0; e < whole.edge_count(); ++e) inner += whole.half_edges[e].size() > 1;
    EXPECT_EQ(boundary_vertices(soup.vertex_count(), torn).size(), soup.faces.corner_count());
    EXPECT_EQ(coincident_boundary_edges(torn, coincident_classes(soup.positions, all)).size(), inner);
    EXPECT_TRUE(coincident_boundary_edges(torn, std::vector<Index>(all.size(), -1)).size() == 0);
  }
}

TEST(TornVertices, AreTheEndsOfInnerEdgesOfASoup) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles), soup = test::as_soup(mesh);
    const EdgeTable table(mesh.vertex_count(), mesh.faces);
    EXPECT_TRUE(open_seam_vertices(mesh, table).empty());
    std::vector<Index> expected;
    for (Index c = 0; c < mesh.faces.corner_count(); ++c)
      if (!table.is_boundary(c) || !table.is_boundary(table.previous[c]))
        expected.push_back(soup.faces.corners()[c]);
    std::ranges::sort(expected);
    EXPECT_EQ(open_seam_vertices(soup, EdgeTable(soup.vertex_count(), soup.faces)), expected);
  }
}

}  // namespace
}  // namespace meshgraft
