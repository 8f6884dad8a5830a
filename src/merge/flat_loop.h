#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

#include "outline.h"

namespace meshgraft {

/// A source's boundary loop in a plane.
struct FlatLoop {
  std::vector<Index> vertices;
  Eigen::RowVector3d axis;        ///< the plane's unit normal, to the side where the source is
  Eigen::RowVector3d first_axis;  ///< of the outline's coordinates
  Eigen::RowVector3d centre;      ///< the outline's origin
  Outline outline;
  bool smoothed = false;  ///< the projected loop crossed itself, and was rounded off
};

/// Projects a source's loop along its area vector. Reverses it first where the source is to be turned over, so
/// that both are consistently oriented. Throws Error(input) for a loop that is no simple boundary loop, spans
/// no area, or cannot be rounded off to one that does not cross itself.
FlatLoop flatten_loop(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop);

}  // namespace meshgraft
