// Checks that the mesh layer ends and keeps its guarantees for any faces that a file may hold.

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/refine.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

// Random faces of 0 to 6 corners over a few vertices, so that all kinds of defects occur; `damage` adds indices
// out of range and coordinates that are not finite.
Mesh soup(unsigned seed, bool damage) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned n) { return static_cast<Index>(random() % n); };
  Mesh mesh;
  const Index vertices = 1 + below(12);
  mesh.positions.resize(vertices, 3);
  for (Eigen::Index k = 0; k < mesh.positions.size(); ++k) mesh.positions.data()[k] = below(4);
  if (damage && below(3) == 0) mesh.positions(below(vertices), 1) = below(2) ? NAN : INFINITY;
  for (Index f = below(16); f > 0; --f) {
    std::vector<Index> face(below(4) ? 3 : below(7));
    for (Index& v : face) v = damage && below(20) == 0 ? below(40) - 20 : below(vertices);
    mesh.faces.push_back(face);
  }
  return mesh;
}

TEST(Soup, TopologyStaysWithinTheMesh) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = soup(seed, seed % 2);
    const TopologySummary summary = summarise_topology(mesh);
    EXPECT_EQ(summary.vertices + summary.isolated_vertices, mesh.vertex_count());
    EXPECT_EQ(summary.genus.has_value(), summary.manifold && summary.oriented);
    const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
    const std::vector<Index> component = connected_components(mesh);
    for (Index v = 0; v < rings.size(); ++v) {
      EXPECT_EQ(rings[v].empty(), component[v] < 0);
      for (const Index w : rings[v]) EXPECT_EQ(component[v], component[w]);
    }
    for (const auto& loop : boundary_loops(mesh)) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const auto ring = rings[loop[k]];
        EXPECT_TRUE(std::binary_search(ring.begin(), ring.end(), loop[(k + 1) % loop.size()]));
      }
    }
    if (summary.manifold && !summary.closed && summary.faces > 0 && summary.edges > 0) {
      EXPECT_FALSE(boundary_loops(mesh).empty());
    }
  }
}

TEST(Soup, OtherAlgorithmsTerminate) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    Mesh mesh = soup(seed, seed % 2);
    const Diagnostics report = check_mesh(mesh);
    const Triangulation pieces = triangulate(mesh, {.skip_out_of_range = true});
    const bool out_of_range = report.find(FindingKind::index_out_of_range) != nullptr;
    EXPECT_EQ(out_of_range, [&] {
      try {
        triangulate(mesh);
        return false;
      } catch (const Error&) {
        return true;
      }
    }());
    const IndexLists lists = vertex_triangles(mesh.vertex_count(), pieces.triangles);
    EXPECT_EQ(vertex_normals(mesh.positions, pieces.triangles, lists).rows(), mesh.vertex_count());

    mesh.attributes.push_back({.name = "normal", .domain = Domain::corner, .components = 3});
    mesh.attributes[0].values.assign(3 * static_cast<std::size_t>(mesh.faces.corner_count()), 1);
    const Points rest = mesh.positions;
    mesh.positions *= 2;
    update_normals(mesh, rest);
    EXPECT_EQ(mesh.attributes[0].values.size(), 3 * static_cast<std::size_t>(mesh.faces.corner_count()));

    std::vector<Index> all(mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) all[v] = v;
    const RefineResult fine = split_edges_within(mesh, all);
    EXPECT_EQ(fine.mesh.attributes[0].values.size(),
              3 * static_cast<std::size_t>(fine.mesh.faces.corner_count()));
    EXPECT_EQ(fine.face_parent.size(), static_cast<std::size_t>(fine.mesh.face_count()));
  }
}

}  // namespace
}  // namespace meshgraft
