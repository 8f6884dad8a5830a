#pragma once

#include <span>

#include <meshgraft/deform/handle.h>

#include "constrained_system.h"

namespace meshgraft {

/// What a handle's affine pose asks of its vertices, less rest, in the units of a patch with this centre and
/// scale (p the place at rest there): the displacement (p, 1) · frame, and (W − I)ᵀ = the first three rows of
/// the frame.
using HandleFrame = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
HandleFrame handle_frame(const HandlePose& pose, const Eigen::RowVector3d& centre, double scale);

/// The known values of unit frames, four columns for each of the handles: (p, 1) at constrained positions, I at
/// constrained transforms. Solutions for them, times the handles' frames, are solutions for the poses.
ConstrainedSystem::Known unit_frame_values(const ConstrainedSystem& system, std::span<const Handle> handles);

/// Throws Error(input) at `location` for numbers that are not finite, or too large to compute with.
void require_usable(const HandlePose& pose, const std::string& location);

/// Throws Error(usage) for another number of poses than handles, Error(input) for a curve that was redrawn
/// (every vertex moves by itself there) and for a number that is not finite, or larger than 1e100.
void require_affine_poses(std::span<const Handle> handles, std::span<const HandlePose> poses);

}  // namespace meshgraft
