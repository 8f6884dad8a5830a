#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The boundary condition of one vertex. Either part may be given without the other.
struct VertexConstraint {
  Index vertex = -1;
  std::optional<Eigen::Vector3d> position{};   ///< edited position u, model units
  std::optional<Eigen::Matrix3d> transform{};  ///< local transform W (rest → edited)
  /// The rotation inside `transform` with all its turns (radians), where it is known: 270° or 720° then spread
  /// as such. Absent: the turn of less than half a circle.
  std::optional<Eigen::AngleAxisd> rotation{};
};

/// A stationary anchor (FT05 section 6): a vertex that is drawn to a place by a soft row. Under
/// `Density::ft05` the row is weight · (x_i − target) beside the vertex's row of E_L; under `aware` it is
/// scaled so that weight 1 is as stiff as bending the region over its own size, at any resolution.
struct Anchor {
  Index vertex = -1;
  double weight = 10;
  std::optional<Eigen::Vector3d> target{};  ///< the rest position if absent
};

/// Vertices that share one unknown map x_i = T p_i + t (FT05 section 7): affine, or a similarity T = scale ·
/// rotation.
struct Feature {
  std::vector<Index> vertices{};
  bool similarity = false;
  std::optional<double> scale{};  ///< of a similarity, where it is not to be found
};

}  // namespace meshgraft
