#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "shapes.h"
#include "support/mesh_families.h"

/// Meshes to cut, and checks of every cut.
namespace meshgraft::test {

struct CutCase {
  std::string name;
  Mesh mesh;
};

inline std::vector<CutCase> cut_cases() {
  std::vector<CutCase> all;
  for (const TestMesh& family : mesh_families())
    all.push_back({family.name, make_mesh(family.positions, family.triangles)});
  all.push_back({"cube", shapes::cube()});
  all.push_back({"grid of quads", shapes::grid(7, 5)});
  all.push_back({"tube of quads", shapes::tube(9, 4)});
  all.push_back({"torus of quads", shapes::torus(11, 6)});
  return all;
}

inline Mesh mesh_of(const TestMesh& mesh) { return make_mesh(mesh.positions, mesh.triangles); }

inline double area(const Mesh& mesh) {
  double sum = 0;
  const Triangles triangles = triangulate(mesh).triangles;
  for (Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = mesh.positions.row(triangles(t, 0)), b = mesh.positions.row(triangles(t, 1)),
                          c = mesh.positions.row(triangles(t, 2));
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

inline Eigen::Vector3d centre(const Mesh& mesh) {
  return (mesh.positions.colwise().minCoeff() + mesh.positions.colwise().maxCoeff()).transpose() / 2;
}

inline double size_of(const Mesh& mesh) {
  return (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
}

inline void expect_simple_loops(const CutResult& cut) {
  const auto all = boundary_loops(cut.mesh);
  std::set<Index> seen;
  for (const auto& loop : all)
    for (const Index v : loop) EXPECT_TRUE(seen.insert(v).second) << "vertex " << v << " is on two loops";
  for (const auto& loop : cut.loops) {
    EXPECT_GE(loop.size(), 3u);
    EXPECT_NE(std::find(all.begin(), all.end(), loop), all.end());
  }
}

inline void expect_sound(const CutResult& cut, const Mesh& uncut) {
  const TopologySummary before = summarise_topology(uncut), after = summarise_topology(cut.mesh);
  EXPECT_EQ(after.manifold, before.manifold);
  EXPECT_EQ(after.oriented, before.oriented);
  EXPECT_FALSE(cut.loops.empty());
  expect_simple_loops(cut);
  ASSERT_EQ(static_cast<Index>(cut.origin.size()), cut.mesh.vertex_count());
  ASSERT_EQ(static_cast<Index>(cut.face_parent.size()), cut.mesh.face_count());
  ASSERT_EQ(static_cast<Index>(cut.vertex.new_index.size()), uncut.vertex_count());
  for (Index v = 0; v < cut.mesh.vertex_count(); ++v) {
    const EdgePoint& o = cut.origin[v];
    const Eigen::RowVector3d p = (1 - o.t) * uncut.positions.row(o.from) + o.t * uncut.positions.row(o.to);
    EXPECT_TRUE((p.array() == cut.mesh.positions.row(v).array()).all());
  }
  Index last = -1;
  for (Index v = 0; v < uncut.vertex_count(); ++v) {
    const Index w = cut.vertex.new_index[v];
    if (w < 0) continue;
    EXPECT_EQ(cut.origin[w].from, v);
    const bool on_cut = std::any_of(cut.loops.begin(), cut.loops.end(), [&](const auto& loop) {
      return std::find(loop.begin(), loop.end(), w) != loop.end();
    });
    if (on_cut) continue;
    EXPECT_GT(w, last) << "the others keep their order";
    last = w;
  }
}

}  // namespace meshgraft::test
