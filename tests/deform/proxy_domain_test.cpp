#include "deform/proxy/proxy_domain.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/normals.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// Returns a domain of a whole scene in which foot and head are held, by holders 0 and 1.
ProxyDomain held_domain(const test::Scene& scene, double spacing) {
  ProxyDomain domain;
  const test::TestMesh& mesh = scene.mesh;
  domain.vertices.resize(static_cast<std::size_t>(mesh.size()));
  std::iota(domain.vertices.begin(), domain.vertices.end(), 0);
  domain.points = mesh.positions;
  domain.centre.setZero();
  domain.triangles = mesh.triangles;
  domain.rings = vertex_rings(mesh.size(), mesh.triangles);
  domain.normals =
      vertex_normals(mesh.positions, mesh.triangles, vertex_triangles(mesh.size(), mesh.triangles));
  domain.spacing = spacing;
  domain.holder.assign(domain.vertices.size(), -1);
  for (const Index v : scene.foot) domain.holder[v] = 0;
  for (const Index v : scene.head) domain.holder[v] = 1;
  return domain;
}

bool is_on_boundary(const ProxyDomain& domain, Index v) {
  const auto ring = domain.rings[v];
  return domain.holder[v] >= 0 &&
         std::any_of(ring.begin(), ring.end(), [&](Index w) { return domain.holder[w] != domain.holder[v]; });
}

TEST(ProxyDomain, WithAllKeepsExactlyTheBoundaries) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    const ProxyDomain domain = held_domain(test::make_scene(mesh), 0.1);
    const Flags kept = vertices_to_keep(domain, true);
    for (Index v = 0; v < domain.size(); ++v) EXPECT_EQ(kept[v] != 0, is_on_boundary(domain, v)) << mesh.name;
  }
}

TEST(ProxyDomain, KeepsBoundaryVerticesNoFartherApartThanTheSpacing) {
  for (const test::TestMesh& mesh : test::mesh_families())
    for (const double share : {0.02, 0.2, 2.0}) {
      SCOPED_TRACE(mesh.name);
      const ProxyDomain domain = held_domain(test::make_scene(mesh), share * mesh.box_diagonal());
      const Flags kept = vertices_to_keep(domain, false);
      for (Index v = 0; v < domain.size(); ++v) {
        if (kept[v]) {
          EXPECT_TRUE(is_on_boundary(domain, v));
        }
        if (!is_on_boundary(domain, v)) continue;
        double nearest = 1e30;
        for (Index w = 0; w < domain.size(); ++w)
          if (kept[w] && domain.holder[w] == domain.holder[v])
            nearest = std::min(nearest, (domain.points.row(v) - domain.points.row(w)).norm());
        EXPECT_LE(nearest, domain.spacing);
      }
    }
}

TEST(ProxyDomain, KeepsTheExtentOfABoundary) {
  // However wide the spacing, the kept vertices of a boundary span about what the boundary spans.
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const ProxyDomain domain = held_domain(test::make_scene(mesh), 1e6);
    const Flags kept = vertices_to_keep(domain, false);
    for (const Index holder : {0, 1}) {
      std::vector<Index> boundary, chosen;
      for (Index v = 0; v < domain.size(); ++v) {
        if (domain.holder[v] != holder || !is_on_boundary(domain, v)) continue;
        boundary.push_back(v);
        if (kept[v]) chosen.push_back(v);
      }
      ASSERT_FALSE(chosen.empty());
      const auto extent = [&](const std::vector<Index>& vertices) {
        double largest = 0;
        for (const Index v : vertices)
          for (const Index w : vertices)
            largest = std::max(largest, (domain.points.row(v) - domain.points.row(w)).norm());
        return largest;
      };
      EXPECT_GE(extent(chosen), 0.5 * extent(boundary));
    }
  }
}

TEST(ProxyDomain, AProxyReachesItsNeighboursAcrossRemovedVertices) {
  for (const test::TestMesh& mesh :
       {test::bumpy_sphere(3), test::irregular_grid(22, 16), test::torus(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const ProxyDomain domain = held_domain(test::make_scene(mesh), 0.1);
    const Flags none(domain.vertices.size(), 0);
    const Decimated proxy = decimate(domain.points, domain.triangles, domain.normals, none, domain.size() / 4);
    const std::vector<double> radii = influence_radii(domain, proxy);
    for (const auto& t : proxy.triangles.rowwise())
      for (int c = 0; c < 3; ++c) {
        const Index a = proxy.vertices[t[c]], b = proxy.vertices[t[(c + 1) % 3]];
        const auto ring = domain.rings[a];
        if (std::find(ring.begin(), ring.end(), b) != ring.end()) continue;
        EXPECT_GT(radii[t[c]], (domain.points.row(a) - domain.points.row(b)).norm());
      }
    // A proxy on all vertices covers nothing but itself.
    const std::vector<double> own = influence_radii(domain, {domain.vertices, domain.triangles});
    EXPECT_EQ(own, std::vector<double>(domain.vertices.size(), 0.0));
  }
}

}  // namespace
}  // namespace meshgraft
