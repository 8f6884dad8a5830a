#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

#include "pair_geometry.h"

namespace meshgraft {

/// Options of the constraints that a pair of loops puts on each source loop vertex v, in loop order. The
/// position is the point v' on the target loop, the local transform is W = S R (FT05 5.1). R turns the
/// tangent frame at v (tangent, normal, their cross product) into that at v'. S is the ratio of the distances
/// of v' and v to the centres of their loops. With `MergePose::keep`, R = I (5.2).
struct BoundaryOptions {
  MergePose pose = MergePose::find;
  std::optional<double> scale{};  ///< S, if prescribed
  double normal_angle_deg = 0;    ///< rotates the target's normals, right hand about its listed direction
};
std::vector<VertexConstraint> boundary_constraints(const LoopPair& pair, const LoopGeometry& source,
                                                   const LoopGeometry& target,
                                                   const Correspondence& correspondence,
                                                   const BoundaryOptions& options);

/// Returns the similarity that best maps the source loops with their normals onto the target loops. Returns I
/// where the loops do not determine it.
Similarity pose_of_boundary(std::span<const LoopGeometry> sources, std::span<const LoopGeometry> targets,
                            std::span<const Correspondence> correspondences, std::optional<double> scale);

}  // namespace meshgraft
