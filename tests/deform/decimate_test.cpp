#include "deform/proxy/decimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// Returns meshes that are fine enough to be decimated.
std::vector<test::TestMesh> fine_families() {
  return {test::icosphere(3),  test::bumpy_sphere(3),        test::bar(5, 20),
          test::torus(20, 40), test::irregular_grid(24, 18), test::flat_sheet(24, 18),
          test::tube(20, 40),  test::plate_with_holes(2, 2), test::minute(test::bumpy_sphere(3))};
}

Decimated decimated(const test::TestMesh& mesh, const Flags& locked, Index target,
                    const Context& context = {}) {
  const Points normals =
      vertex_normals(mesh.positions, mesh.triangles, vertex_triangles(mesh.size(), mesh.triangles));
  return decimate(mesh.positions, mesh.triangles, normals, locked, target, context);
}

/// Returns the length of the longest edge over the median length.
double longest_over_median(const test::TestMesh& mesh, const Decimated& coarse) {
  std::vector<double> lengths;
  for (const auto& t : coarse.triangles.rowwise())
    for (int c = 0; c < 3; ++c)
      lengths.push_back(
          (mesh.positions.row(coarse.vertices[t[c]]) - mesh.positions.row(coarse.vertices[t[(c + 1) % 3]]))
              .norm());
  std::sort(lengths.begin(), lengths.end());
  return lengths.back() / lengths[lengths.size() / 2];
}

Mesh coarse_mesh(const test::TestMesh& mesh, const Decimated& coarse) {
  return make_mesh(mesh.positions(coarse.vertices, Eigen::all), coarse.triangles);
}

TEST(Decimate, KeepsTopologyOnVerticesOfTheSurface) {
  for (const test::TestMesh& mesh : fine_families()) {
    SCOPED_TRACE(mesh.name);
    const TopologySummary was = summarise_topology(make_mesh(mesh.positions, mesh.triangles));
    const Decimated coarse = decimated(mesh, Flags(static_cast<std::size_t>(mesh.size()), 0), mesh.size() / 5);
    EXPECT_TRUE(std::is_sorted(coarse.vertices.begin(), coarse.vertices.end()));
    EXPECT_EQ(std::adjacent_find(coarse.vertices.begin(), coarse.vertices.end()), coarse.vertices.end());
    EXPECT_GE(coarse.vertices.front(), 0);
    EXPECT_LT(coarse.vertices.back(), mesh.size());
    const TopologySummary is = summarise_topology(coarse_mesh(mesh, coarse));
    EXPECT_EQ(is.isolated_vertices, 0);
    EXPECT_TRUE(is.manifold && is.oriented);
    EXPECT_EQ(is.closed, was.closed);
    EXPECT_EQ(is.euler_characteristic, was.euler_characteristic);
    EXPECT_EQ(is.boundary_loops, was.boundary_loops);
  }
}

TEST(Decimate, LeavesAboutAsManyVerticesAsAskedFor) {
  for (const test::TestMesh& mesh : fine_families())
    for (const Index share : {2, 4, 8}) {
      const Index target = mesh.size() / share;
      const Decimated coarse = decimated(mesh, Flags(static_cast<std::size_t>(mesh.size()), 0), target);
      EXPECT_GT(static_cast<Index>(coarse.vertices.size()), target / 2) << mesh.name;
      EXPECT_LT(static_cast<Index>(coarse.vertices.size()), 2 * target) << mesh.name;
    }
}

TEST(Decimate, KeepsLockedVerticesButThoseOfPockets) {
  for (const test::TestMesh& mesh : fine_families()) {
    SCOPED_TRACE(mesh.name);
    Flags locked(static_cast<std::size_t>(mesh.size()), 0);
    Index count = 0, kept = 0;
    for (Index v = 3; v < mesh.size(); v += 11) locked[v] = 1;
    const Decimated coarse = decimated(mesh, locked, mesh.size() / 6);
    for (const Index v : coarse.vertices) kept += locked[v];
    for (const std::uint8_t flag : locked) count += flag;
    EXPECT_GT(kept, 0.9 * count);  // the others were in pockets, whose faces lay back to back
    const TopologySummary topology = summarise_topology(coarse_mesh(mesh, coarse));
    EXPECT_TRUE(topology.manifold && topology.oriented);
  }
}

TEST(Decimate, SpreadsVerticesEvenlyAlsoWhereTheSurfaceIsFlat) {
  for (const test::TestMesh& mesh :
       {test::flat_sheet(24, 18), test::bar(6, 24), test::irregular_grid(24, 18)}) {
    const Decimated coarse = decimated(mesh, Flags(static_cast<std::size_t>(mesh.size()), 0), mesh.size() / 5);
    EXPECT_LT(longest_over_median(mesh, coarse), 6) << mesh.name;
  }
}

// More than 131,072 triangles are thinned in chunks first.
TEST(Decimate, ThinsLargeSurfacesInChunksThatLeaveNoTrace) {
  for (const test::TestMesh& mesh : {test::torus(320, 320), test::irregular_grid(300, 300)}) {
    SCOPED_TRACE(mesh.name);
    Flags locked(static_cast<std::size_t>(mesh.size()), 0);
    for (Index v = 0; v < mesh.size(); v += 1000) locked[v] = 1;
    const Decimated coarse = decimated(mesh, locked, 3000);
    EXPECT_NEAR(static_cast<double>(coarse.vertices.size()), 3000, 300);
    EXPECT_LT(longest_over_median(mesh, coarse), 6);
    const auto kept = std::ranges::count_if(coarse.vertices, [](Index v) { return v % 1000 == 0; });
    EXPECT_GT(static_cast<double>(kept), 0.9 * static_cast<double>(mesh.size()) / 1000);
    const TopologySummary was = summarise_topology(make_mesh(mesh.positions, mesh.triangles));
    const TopologySummary is = summarise_topology(coarse_mesh(mesh, coarse));
    EXPECT_TRUE(is.manifold && is.oriented);
    EXPECT_EQ(is.euler_characteristic, was.euler_characteristic);
    EXPECT_EQ(is.boundary_loops, was.boundary_loops);
    const Decimated on_one_thread = decimated(mesh, locked, 3000, Context{.threads = 1});
    EXPECT_EQ(coarse.vertices, on_one_thread.vertices);
    EXPECT_EQ(coarse.triangles, on_one_thread.triangles);
  }
}

TEST(Decimate, GivesTheSameTwiceAndInAnyUnit) {
  for (const test::TestMesh& mesh : fine_families()) {
    const Flags locked(static_cast<std::size_t>(mesh.size()), 0);
    test::TestMesh doubled = mesh;
    doubled.positions *= 1024;
    const Decimated once = decimated(mesh, locked, mesh.size() / 5),
                    again = decimated(mesh, locked, mesh.size() / 5),
                    scaled = decimated(doubled, locked, mesh.size() / 5);
    EXPECT_EQ(once.vertices, again.vertices) << mesh.name;
    EXPECT_EQ(once.triangles, again.triangles) << mesh.name;
    EXPECT_EQ(once.vertices, scaled.vertices) << mesh.name;
    EXPECT_EQ(once.triangles, scaled.triangles) << mesh.name;
  }
}

TEST(Decimate, LeavesOutVerticesWithoutAFace) {
  const test::TestMesh mesh = test::with_isolated_vertices(test::irregular_grid(18, 12));
  const Decimated coarse = decimated(mesh, Flags(static_cast<std::size_t>(mesh.size()), 0), mesh.size() / 4);
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  for (const Index v : coarse.vertices) EXPECT_FALSE(rings[v].empty());
}

}  // namespace
}  // namespace meshgraft
