#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

#include "outline.h"

namespace meshgraft {

/// A source's boundary loop projected to a plane.
struct FlatLoop {
  std::vector<Index> vertices;
  Eigen::RowVector3d axis;        ///< the plane's unit normal, towards the source
  Eigen::RowVector3d first_axis;  ///< first axis of the outline's coordinates
  Eigen::RowVector3d centre;      ///< the outline's origin
  Outline outline;
  bool smoothed = false;  ///< the projected loop crossed itself and was smoothed
};

/// Projects a source's loop along its area vector. Reverses the loop first where the source will be turned
/// over, so that both meshes are consistently oriented. Throws Error(input) for a loop that is not a simple
/// boundary loop, spans no area, or still crosses itself after smoothing.
FlatLoop flatten_loop(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop);

/// Returns the footprint of a source that stands on several loops: the convex hull of all of them, projected
/// along the first one's axis. It has no vertices of its own.
FlatLoop hull_of_loops(const Points& source, const std::vector<FlatLoop>& loops);

/// Returns a loop moved by a similarity.
FlatLoop moved(const FlatLoop& loop, const Eigen::Affine3d& map);

}  // namespace meshgraft
