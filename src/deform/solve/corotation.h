#pragma once

#include <Eigen/Core>

#include <meshgraft/linalg/linear_solver.h>

#include "linalg/sparse.h"

namespace meshgraft {

// One co-rotational iteration, for all vertices of the surface or for samples of it.

/// The iterations stop when the root mean square change of the field falls below this, in radians.
constexpr double settled_change = 1e-4;

/// The tolerances of an iterative backend, for a step's solve and the smoothing of its field, per radian of the
/// change that the step before asked for. For the first step and for larger changes, that is `first_change`.
constexpr double solve_share = 1e-3, smooth_share = 1e-4, first_change = 0.1;

/// The change that the first step after a `CoarseStart` is expected to ask for, in radians.
constexpr double change_after_start = 2e-3;

/// The map that the constraints alone give at a point of the surface: F = rotation · stretch.
struct BlendedMap {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(), stretch = Eigen::Matrix3d::Identity();
};

/// Returns the rotation vector that takes the blended rotation to the rotation of the surface's own map.
/// Among equal rotations it takes the vector nearest to `current`. `normal` is the normal at rest if the map
/// was fitted to a flat ring only, so that the image of the normal is arbitrary. Otherwise `normal` is zero.
Eigen::Vector3d surface_turn(const Eigen::Matrix3d& map, const BlendedMap& blended,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& current);

}  // namespace meshgraft
