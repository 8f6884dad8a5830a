#pragma once

#include <span>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>

#include "constrained_system.h"

namespace meshgraft {

/// The change that a handle's affine pose causes, in the units of a patch with this centre and scale. With p
/// the position at rest in these units, a vertex is displaced by (p, 1) · frame. The first three rows of the
/// frame are (W − I)ᵀ.
using PoseMatrix = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
PoseMatrix pose_matrix(const HandlePose& pose, const Eigen::RowVector3d& centre, double scale);

/// Returns the known values of unit frames, four columns per handle: (p, 1) at constrained positions, I at
/// constrained transforms. Solutions for these values, times the handles' frames, are solutions for the
/// poses.
ConstrainedSystem::Known unit_frame_values(const ConstrainedSystem& system, std::span<const Handle> handles);

/// Throws Error(input) at `location` if a number is not finite or too large to compute with.
void validate(const HandlePose& pose, const Location& location);

/// Throws Error(usage) if the numbers of poses and handles differ. Throws Error(input) if a curve was
/// redrawn, since its vertices then move independently. Throws Error(input) for a number that is not finite
/// or larger than 1e100.
void require_affine_poses(std::span<const Handle> handles, std::span<const HandlePose> poses);

}  // namespace meshgraft
