#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A side on which a source may stand.
struct BaseSide {
  Eigen::Vector3d up;  ///< unit length, from the side into the source
  bool flat = false;   ///< the source ends there in a plane
  bool lowest = false;
};

/// Returns the sides on which a source may stand: first a flat lowest side, other flat sides by their area, and
/// the lowest side; then the ends of the longest extent and the sides of the coordinate axes. The lowest side
/// is that of the axis that points up.
std::vector<BaseSide> base_sides(const Mesh& source);

}  // namespace meshgraft
