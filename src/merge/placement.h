#pragma once

#include <Eigen/Geometry>

#include "flat_loop.h"
#include "prepared_target.h"

namespace meshgraft {

/// The orientation of a loop's outline on a surface: the images of its unit axes.
struct Placement {
  Eigen::RowVector3d normal, first_axis;
};

/// Turns the outline onto the tangent plane at a point by the smallest rotation, then spins it about the
/// normal. The normal is averaged over the outline in the given size.
Placement place_outline(const PreparedTarget& target, const SurfacePoint& point, const FlatLoop& loop,
                        double size, double spin_deg);

/// Turns a vector by the smallest rotation that maps the direction `from` to `to`.
Eigen::RowVector3d turned(const Eigen::RowVector3d& vector, const Eigen::RowVector3d& from,
                          const Eigen::RowVector3d& to);

/// Returns the similarity that brings the source's loop into the placement, centred at `centre`.
Eigen::Affine3d placement_map(const FlatLoop& loop, const Placement& placement, double size,
                              const Eigen::RowVector3d& centre);

}  // namespace meshgraft
