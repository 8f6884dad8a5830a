#include "mesh/simple_surface.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "mesh/closed_components.h"
#include "mesh/coincident.h"
#include "mesh/fans.h"
#include "mesh/winding.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

// Returns the mesh with its vertices numbered at random.
Mesh renumbered(const Mesh& mesh) {
  std::vector<Index> number(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(number.begin(), number.end(), 0);
  std::mt19937 random(1);
  std::shuffle(number.begin(), number.end(), random);
  Points positions(mesh.positions.rows(), 3);
  for (Index v = 0; v < mesh.vertex_count(); ++v) positions.row(number[v]) = mesh.positions.row(v);
  Triangles triangles(mesh.face_count(), 3);
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (int c = 0; c < 3; ++c) triangles(f, c) = number[mesh.faces[f][static_cast<std::size_t>(c)]];
  return make_mesh(positions, triangles);
}

std::vector<Mesh> surfaces() {
  std::vector<Mesh> meshes;
  for (const test::TestMesh& family : test::mesh_families()) {
    meshes.push_back(make_mesh(family.positions, family.triangles));
    meshes.push_back(renumbered(meshes.back()));
  }
  meshes.push_back(turned_over(meshes.front()));
  meshes.push_back(test::both(meshes[0], turned_over(meshes[0])));
  meshes.push_back(test::with_isolated(meshes[0], 3, 1));
  meshes.push_back(test::without_faces(meshes[0], 2, 0, 1));
  for (const test::TestMesh& large : test::large_families(40000)) {  // several blocks of vertices
    meshes.push_back(make_mesh(large.positions, large.triangles));
    meshes.push_back(renumbered(meshes.back()));
  }
  return meshes;
}

// Returns whether a table of edges, and the fans that it gives, say what `SimpleSurface` says.
bool is_simple_by_edges(const Mesh& mesh) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (table.half_edges[e].size() > 2 || consistently_oriented(mesh, table, e) == false) return false;
  return table.usable_faces == mesh.face_count() &&
         std::ranges::all_of(fan_counts(mesh, table), [](Index fans) { return fans <= 1; });
}

TEST(SimpleSurface, HasTheConnectivityOfTheTableOfEdges) {
  int simple = 0;
  for (const Mesh& mesh : surfaces()) {
    const auto surface = find_simple_surface(mesh);
    ASSERT_EQ(surface != nullptr, is_simple_by_edges(mesh));
    if (!surface) continue;
    ++simple;
    const Connectivity found = connectivity(mesh, *surface);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
    EXPECT_EQ(found.rings.offsets, rings.offsets);
    EXPECT_EQ(found.rings.values, rings.values);
    EXPECT_EQ(found.components, connected_components(mesh));
    EXPECT_EQ(found.loops, boundary_loops(mesh));
    EXPECT_EQ(surface->is_closed(), summarise_topology(mesh).closed);
  }
  EXPECT_GT(simple, 20);
}

TEST(SimpleSurface, HasTheInwardComponentsAndSeamsOfTheTableOfEdges) {
  for (Mesh mesh : surfaces()) {
    const auto surface = find_simple_surface(mesh);
    if (!surface) continue;
    const EdgeTable table(mesh.vertex_count(), mesh.faces);
    const InwardComponents inward = inward_components(mesh, *surface),
                           expected = inward_components(mesh, table);
    EXPECT_EQ(inward.component, expected.component);
    EXPECT_EQ(inward.components, expected.components);
    EXPECT_EQ(open_seam_vertices(mesh, *surface), open_seam_vertices(mesh, table));
  }
  const test::TestMesh sheet = test::grid(6, 5);
  const Mesh soup = test::as_soup(make_mesh(sheet.positions, sheet.triangles));
  const auto surface = find_simple_surface(soup);
  ASSERT_TRUE(surface);
  EXPECT_EQ(open_seam_vertices(soup, *surface),
            open_seam_vertices(soup, EdgeTable(soup.vertex_count(), soup.faces)));
  EXPECT_FALSE(open_seam_vertices(soup, *surface).empty());
}

TEST(SimpleSurface, IsNotFoundWithADefectOfItsConnections) {
  const test::TestMesh ball = test::bumpy_sphere(3);
  const Mesh clean = make_mesh(ball.positions, ball.triangles);
  ASSERT_TRUE(find_simple_surface(clean));
  for (const FindingKind kind : test::defect_kinds()) {
    const test::Defective defective = test::inject(clean, kind);
    if (defective.count == 0) continue;
    SCOPED_TRACE(name_of(kind));
    EXPECT_EQ(find_simple_surface(defective.mesh) != nullptr, is_simple_by_edges(defective.mesh));
  }
  Mesh with_polygon = clean;
  with_polygon.faces.push_back(std::vector<Index>{0, 1, 2, 3});
  EXPECT_FALSE(find_simple_surface(with_polygon));
  EXPECT_FALSE(find_simple_surface(Mesh()));
}

TEST(SimpleSurfaceThreads, DoNotChangeIt) {
  for (const Mesh& mesh : surfaces()) {
    const auto one = find_simple_surface(mesh, {.threads = 1}), two = find_simple_surface(mesh, {.threads = 2});
    ASSERT_EQ(one != nullptr, two != nullptr);
    if (!one) continue;
    EXPECT_EQ(one->faces_around.values, two->faces_around.values);
    EXPECT_EQ(one->leaving, two->leaving);
    EXPECT_EQ(one->components, two->components);
  }
}

}  // namespace
}  // namespace meshgraft
