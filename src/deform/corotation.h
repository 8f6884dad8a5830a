#pragma once

#include <Eigen/Core>

#include <meshgraft/linalg/sparse.h>

namespace meshgraft {

// One co-rotational step, for whatever stands for the surface: all of its vertices, or some samples of it.

/// Where the steps stop: the field would change by less, root mean square, radians.
constexpr double settled_change = 1e-3;

/// What the constraints alone say of a place: F = rotation · stretch.
struct BlendedMap {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(), stretch = Eigen::Matrix3d::Identity();
};

/// The rotation vector that takes the blended rotation to that of the surface's own map, near `current`. The
/// normal is that at rest, where nothing but a flat ring was fitted so that the map could do anything to it;
/// else zero.
Eigen::Vector3d surface_turn(const Eigen::Matrix3d& map, const BlendedMap& blended,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& current);

/// How much of the next step to take: full steps while they go one way, shorter ones where they turn back, by
/// how much they do, and longer again afterwards. Continuous, so that neighbouring frames stay neighbours.
double damped_pace(double pace, const Columns& step, const Columns& previous);

}  // namespace meshgraft
