#include "mesh/edge_table.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "shapes.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// Families with and without defects that change how many faces an edge has.
std::vector<Mesh> meshes_with_any_edges() {
  std::vector<Mesh> meshes = {shapes::cube(), shapes::moebius_strip(), shapes::three_on_an_edge(),
                              shapes::bow_tie()};
  for (const test::TestMesh& family : test::small_families()) {
    meshes.push_back(make_mesh(family.positions, family.triangles));
    meshes.push_back(test::with_fins(meshes.back(), 3, 1));
    meshes.push_back(test::with_repeated_faces(meshes.back(), 3, 1));
    const Index v = meshes.back().faces.corners()[0], w = meshes.back().faces.corners()[1];
    meshes.back().faces.push_back(std::vector<Index>{v, w, v});
  }
  return meshes;
}

TEST(EdgeTable, ListsEachHalfEdgeOnce) {
  for (const Mesh& mesh : meshes_with_any_edges()) {
    const EdgeTable table(mesh.vertex_count(), mesh.faces);
    const std::vector<Index>& corners = mesh.faces.corners();
    Index listed = 0;
    for (Index e = 0; e < table.edge_count(); ++e) {
      EXPECT_TRUE(std::ranges::is_sorted(table.half_edges[e]));
      for (const Index c : table.half_edges[e]) {
        ++listed;
        ASSERT_EQ(table.edge[c], e);
        EXPECT_EQ(table.is_boundary(c), table.half_edges[e].size() == 1);
        const auto [low, high] = std::minmax(corners[c], corners[table.next[c]]);
        EXPECT_EQ(table.ends[e], (std::array{low, high}));
        EXPECT_EQ(table.previous[table.next[c]], c);
        EXPECT_EQ(table.next[table.previous[c]], c);
      }
    }
    EXPECT_EQ(listed, std::ranges::count_if(table.next, [](Index c) { return c >= 0; }));
    EXPECT_TRUE(std::ranges::is_sorted(table.ends));
    EXPECT_EQ(std::ranges::adjacent_find(table.ends), table.ends.end());
  }
}

TEST(EdgeTable, LeavesOutFacesOfFewerThanThreeCorners) {
  Mesh mesh = shapes::grid(2, 2);
  const Index edges = EdgeTable(mesh.vertex_count(), mesh.faces).edge_count();
  for (const std::vector<Index>& face : {std::vector<Index>{}, {0}, {0, 8}, {0, 0, 8}, {0, 8, 99}, {0, -1, 8}})
    mesh.faces.push_back(face);
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  EXPECT_EQ(table.edge_count(), edges);
  EXPECT_EQ(table.usable_faces, 4);
}

TEST(ListEdges, AgreesWithTheEdgeTable) {
  for (const Mesh& mesh : meshes_with_any_edges()) {
    const Triangles triangles = triangulate(mesh).triangles;
    const Mesh split = make_mesh(mesh.positions, triangles);
    const EdgeTable table(mesh.vertex_count(), split.faces);
    const auto edges = list_edges(triangles, vertex_triangles(mesh.vertex_count(), triangles));
    ASSERT_EQ(edges.size(), table.edge_count());
    for (Index e = 0; e < table.edge_count(); ++e) {
      const auto along = table.half_edges[e];
      EXPECT_EQ(edges[e].ends, table.ends[e]);
      EXPECT_EQ(edges[e].faces[0], along[0] / 3);
      EXPECT_EQ(edges[e].faces[1], along.size() > 1 ? along[1] / 3 : -1);
      const auto forward =
          std::ranges::count_if(along, [&](Index c) { return split.faces.corners()[c] == table.ends[e][0]; });
      EXPECT_EQ(edges[e].forward, forward);
      EXPECT_EQ(edges[e].backward, std::ssize(along) - forward);
    }
  }
}

}  // namespace
}  // namespace meshgraft
