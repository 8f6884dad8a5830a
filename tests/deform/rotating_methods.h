#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

/// Edits by the methods that follow rotations.
namespace meshgraft::test {

inline constexpr DeformMethod rotating_methods[] = {DeformMethod::rotation_aware, DeformMethod::corotational,
                                                    DeformMethod::shell};

inline DeformerOptions options_of(DeformMethod method, double stiffness = DeformerOptions{}.stiffness) {
  return {.method = method, .stiffness = stiffness};
}

inline std::string describe(const DeformerOptions& options) {
  return std::string(to_string(options.method)) + ", stiffness " + std::to_string(options.stiffness);
}

/// Returns the options of these methods, with and without stiffness.
inline std::vector<DeformerOptions> method_variants() {
  std::vector<DeformerOptions> variants;
  for (const DeformMethod method : rotating_methods)
    for (const double stiffness : {0.0, DeformerOptions{}.stiffness})
      variants.push_back(options_of(method, stiffness));
  return variants;
}

inline Deformer make_deformer(const Scene& scene, const Region& region, const DeformerOptions& options) {
  return {scene.mesh.positions, scene.mesh.triangles, region, options};
}

inline Points edit_head(const Scene& scene, const DeformerOptions& options) {
  return make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(head_move(scene))});
}

/// Returns the tolerance for rounding. Co-rotational iterations amplify it in badly conditioned solves, so that
/// triangles of 1:1000 cost two digits.
inline double step_tolerance(const TestMesh& mesh, const DeformerOptions& options) {
  const bool needles =
      mesh.name.find("needle") != std::string::npos || mesh.name.find("fan pole") != std::string::npos;
  if (!needles) return 1e-9;
  return options.method == DeformMethod::shell          ? 1e-5
         : options.method == DeformMethod::corotational ? 1e-7
                                                        : 1e-9;
}

/// Returns the largest distance over the vertices of faces, relative to the box.
inline double relative_distance(const TestMesh& mesh, const Points& a, const Points& b) {
  double largest = 0;
  for (Index v : mesh.triangles.reshaped()) largest = std::max(largest, (a.row(v) - b.row(v)).norm());
  return largest / mesh.box_diagonal();
}

/// Returns a turn about the head's first vertex that keeps its number of whole turns.
inline HandlePose turned(const Scene& scene, double angle_deg,
                         const Eigen::Vector3d& axis = Eigen::Vector3d(1, -2, 0.5)) {
  HandleMotion motion;
  motion.axis = axis;
  motion.angle_deg = angle_deg;
  return make_pose(motion, scene.mesh.positions.row(scene.head.front()));
}

}  // namespace meshgraft::test
