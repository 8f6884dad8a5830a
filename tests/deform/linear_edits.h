#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

/// Edits by the linear method, whose laws hold in every pose.
namespace meshgraft::test {

/// Degenerate treatments whose thresholds rounding does not cross.
inline const std::vector<DegenerateTreatment> smooth_treatments{DegenerateTreatment::apex};

inline Deformer make_deformer(const Scene& scene, const Region& region, const OperatorOptions& options = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, linear_method(options)};
}

inline Points edit_head(const Scene& scene, const OperatorOptions& options = {}) {
  return make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(head_move(scene))});
}

/// Checks that the vertices of faces follow `map`.
inline void expect_affine(const TestMesh& mesh, const Points& result, const Eigen::Affine3d& map) {
  const Points expected = image(mesh.positions, map);
  double error = 0;
  for (Index v : mesh.triangles.reshaped()) error = std::max(error, (result.row(v) - expected.row(v)).norm());
  EXPECT_LE(error, std::max({1e-10 * mesh.box_diagonal(), eight_ulp(expected), eight_ulp(mesh.positions)}));
}

}  // namespace meshgraft::test
