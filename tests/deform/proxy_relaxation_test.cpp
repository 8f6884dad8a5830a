#include "deform/proxy/proxy_relaxation.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A fine surface in two groups with a coarse triangulation of it.
struct RelaxationScene {
  test::TestMesh mesh;
  IndexLists rings;
  std::vector<Index> group;
  Flags locked;
  Decimated coarse;

  explicit RelaxationScene(test::TestMesh family) : mesh(std::move(family)) {
    const IndexLists faces_at = vertex_triangles(mesh.size(), mesh.triangles);
    rings = vertex_rings(mesh.triangles, faces_at);
    const double middle = mesh.positions.col(1).mean();
    for (Index v = 0; v < mesh.size(); ++v) {
      group.push_back(mesh.positions(v, 1) > middle ? 1 : -1);
      locked.push_back(v % 13 == 5);
    }
    const Points normals = vertex_normals(mesh.positions, mesh.triangles, faces_at);
    coarse = decimate(mesh.positions, mesh.triangles, normals, locked, mesh.size() / 4);
  }
  Decimated relaxed(int rounds) const {
    Decimated result = coarse;
    relax_proxy({mesh.positions, rings, group, locked}, result, rounds);
    return result;
  }
  Mesh surface(const Decimated& triangulation) const {
    return make_mesh(mesh.positions(triangulation.vertices, Eigen::all), triangulation.triangles);
  }
};

std::vector<RelaxationScene> relaxation_scenes() {
  std::vector<RelaxationScene> scenes;
  for (const test::TestMesh& mesh : {test::bumpy_sphere(3), test::torus(20, 40), test::irregular_grid(24, 18),
                                     test::flat_sheet(24, 18), test::tube(20, 40), test::bar(5, 20)})
    scenes.emplace_back(mesh);
  return scenes;
}

/// Returns the mean over the triangles of 4√3 area / Σ squared edges: 1 for equilateral ones.
double mean_quality(const Mesh& mesh) {
  double sum = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto t = mesh.faces[f];
    const Eigen::RowVector3d a = mesh.positions.row(t[0]), b = mesh.positions.row(t[1]),
                             c = mesh.positions.row(t[2]);
    sum += 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() /
           ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
  }
  return sum / mesh.face_count();
}

TEST(ProxyRelaxation, MovesVerticesOverTheSurfaceAlone) {
  for (const RelaxationScene& scene : relaxation_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Decimated result = scene.relaxed(4);
    EXPECT_TRUE(std::is_sorted(result.vertices.begin(), result.vertices.end()));
    EXPECT_EQ(std::adjacent_find(result.vertices.begin(), result.vertices.end()), result.vertices.end());
    EXPECT_EQ(result.vertices.size(), scene.coarse.vertices.size());
    for (const Index v : result.vertices) EXPECT_TRUE(v >= 0 && v < scene.mesh.size());
    const TopologySummary was = summarise_topology(scene.surface(scene.coarse)),
                          is = summarise_topology(scene.surface(result));
    EXPECT_TRUE(is.manifold && is.oriented);
    EXPECT_EQ(is.euler_characteristic, was.euler_characteristic);
    EXPECT_EQ(is.boundary_loops, was.boundary_loops);
    EXPECT_EQ(is.faces, was.faces);
  }
}

TEST(ProxyRelaxation, KeepsLockedVerticesGroupsAndTheOutline) {
  for (const RelaxationScene& scene : relaxation_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Decimated result = scene.relaxed(4);
    const std::set<Index> before(scene.coarse.vertices.begin(), scene.coarse.vertices.end()),
        after(result.vertices.begin(), result.vertices.end());
    std::map<Index, int> groups;
    for (const Index v : before) ++groups[scene.group[v]];
    for (const Index v : after) --groups[scene.group[v]];
    for (const auto& [group, difference] : groups) EXPECT_EQ(difference, 0) << "of group " << group;
    for (const Index v : before)
      if (scene.locked[v]) {
        EXPECT_TRUE(after.contains(v));
      }
    for (const auto& loop : boundary_loops(scene.surface(scene.coarse)))
      for (const Index k : loop) EXPECT_TRUE(after.contains(scene.coarse.vertices[k]));
  }
}

TEST(ProxyRelaxation, MakesTrianglesMoreEquilateral) {
  for (const RelaxationScene& scene : relaxation_scenes())
    EXPECT_GT(mean_quality(scene.surface(scene.relaxed(4))), mean_quality(scene.surface(scene.coarse)))
        << scene.mesh.name;
}

TEST(ProxyRelaxation, WithoutRoundsKeepsTheVertices) {
  for (const RelaxationScene& scene : relaxation_scenes())
    EXPECT_EQ(scene.relaxed(0).vertices, scene.coarse.vertices) << scene.mesh.name;
}

TEST(ProxyRelaxation, WithEveryVertexLockedMovesNone) {
  for (RelaxationScene scene : relaxation_scenes()) {
    std::fill(scene.locked.begin(), scene.locked.end(), std::uint8_t{1});
    EXPECT_EQ(scene.relaxed(3).vertices, scene.coarse.vertices) << scene.mesh.name;
  }
}

}  // namespace
}  // namespace meshgraft
