#pragma once

#include <optional>
#include <vector>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// What a pair of loops asks of each source loop vertex, in its order: the place v' on the target loop and the
/// local transform W = S R (FT05 5.1). R turns the frame at v (tangent, normal, their cross product) into the
/// frame at v', S is the ratio of their distances to the loops' centres; with `MergePose::keep` R = I (5.2).
struct BoundaryOptions {
  MergePose pose = MergePose::find;
  std::optional<double> scale{};  ///< S, where it is given
  double normal_angle_deg = 0;    ///< turns the target's normals, right hand about its listed direction
};
std::vector<VertexConstraint> boundary_constraints(const LoopPair& pair, const LoopGeometry& source,
                                                   const LoopGeometry& target,
                                                   const Correspondence& correspondence,
                                                   const BoundaryOptions& options);

/// The similarity that takes loops with their normals to their places best. I where they leave it open.
Similarity pose_of_boundary(std::span<const LoopGeometry> sources, std::span<const LoopGeometry> targets,
                            std::span<const Correspondence> correspondences, std::optional<double> scale);

}  // namespace meshgraft
