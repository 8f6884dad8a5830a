#pragma once

#include <memory>
#include <numbers>
#include <vector>

#include "merge/flat_loop.h"
#include "merge/prepared_target.h"

#include "merge/closed_curves.h"
#include "mesh/shapes.h"
#include "support/mesh_families.h"

/// Targets and loops for the algorithms that drop a source onto a surface.
namespace meshgraft::test {

inline std::shared_ptr<const Mesh> shared_mesh(const TestMesh& mesh) {
  return std::make_shared<const Mesh>(make_mesh(mesh.positions, mesh.triangles));
}

/// Returns the flat loop of a curve in the plane z = 0, whose source would stand above it.
inline FlatLoop flat_loop_of(const Points& curve) {
  FlatLoop loop{{},
                Eigen::RowVector3d::UnitZ(),
                Eigen::RowVector3d::UnitX(),
                Eigen::RowVector3d::Zero(),
                Outline(PlanePoints(curve.leftCols<2>()))};
  for (Index k = 0; k < static_cast<Index>(curve.rows()); ++k) loop.vertices.push_back(k);
  return loop;
}

/// Returns loops about 0.4 wide: round, oval and star-shaped.
inline std::vector<FlatLoop> flat_loops() {
  std::vector<FlatLoop> loops;
  for (const ClosedCurve& curve : closed_curves())
    if (curve.size() == 41) loops.push_back(flat_loop_of(0.2 * curve.points));
  return loops;
}

}  // namespace meshgraft::test
