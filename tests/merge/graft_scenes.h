#pragma once

#include <utility>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "support/mesh_families.h"

/// Sources with one loop, for the solve of a graft.
namespace meshgraft::test {

/// A source with one loop that is grafted.
struct GraftScene {
  TestMesh mesh;
  IndexLists rings;
  std::vector<std::vector<Index>> loops;
  std::vector<Index> component;

  explicit GraftScene(TestMesh family)
      : mesh(std::move(family)), rings(vertex_rings(mesh.size(), mesh.triangles)) {
    const Mesh whole = make_mesh(mesh.positions, mesh.triangles);
    loops = {boundary_loops(whole).at(0)};
    component = connected_components(whole);
  }
};

inline std::vector<GraftScene> graft_scenes() {
  std::vector<GraftScene> scenes;
  for (const TestMesh& mesh : {tube(12, 20), irregular_grid(14, 9), grid(12, 12), tube(9, 7)})
    scenes.emplace_back(mesh);
  return scenes;
}

/// Constrains the loop of a scene to its image under a map.
inline std::vector<VertexConstraint> constraints_of(const GraftScene& scene, const Eigen::Affine3d& map) {
  std::vector<VertexConstraint> constraints;
  for (const Index v : scene.loops[0])
    constraints.push_back(
        {v, map * Eigen::Vector3d(scene.mesh.positions.row(v).transpose()), Eigen::Matrix3d(map.linear())});
  return constraints;
}

}  // namespace meshgraft::test
