#pragma once

#include <Eigen/Geometry>

#include "flat_loop.h"
#include "prepared_target.h"

namespace meshgraft {

/// How a loop's outline lies on a surface: the unit axes that its own come to.
struct Placement {
  Eigen::RowVector3d normal, first_axis;
};

/// Turns the outline the shortest way onto the tangent plane at a point, then spins it about the normal there.
/// The normal is averaged over the outline in the given size.
Placement place_outline(const PreparedTarget& target, const SurfacePoint& point, const FlatLoop& loop,
                        double size, double spin_deg);

/// Turns a vector the shortest way that takes one direction to another.
Eigen::RowVector3d turned(const Eigen::RowVector3d& vector, const Eigen::RowVector3d& from,
                          const Eigen::RowVector3d& to);

/// The similarity that brings the source's loop into the placement, around `centre`.
Eigen::Affine3d placement_map(const FlatLoop& loop, const Placement& placement, double size,
                              const Eigen::RowVector3d& centre);

}  // namespace meshgraft
