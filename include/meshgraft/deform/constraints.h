#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The boundary condition of one vertex. Position and transform may each be given without the other.
struct VertexConstraint {
  Index vertex = -1;
  std::optional<Eigen::Vector3d> position{};   ///< edited position u, model units
  std::optional<Eigen::Matrix3d> transform{};  ///< local transform W (rest → edited)
  /// The rotation inside `transform` with all its turns (radians), where it is known: 270° or 720° are then
  /// spread as such. Absent: the rotation of less than 180°.
  std::optional<Eigen::AngleAxisd> rotation{};
};

/// A stationary anchor (FT05 section 6): a soft row draws the vertex to a target position. Under
/// `Density::ft05` the row is weight · (x_i − target) beside the vertex's row of E_L. Under `aware` it is
/// scaled so that weight 1 is as stiff as bending the region over its own size, at any resolution.
struct Anchor {
  Index vertex = -1;
  double weight = 10;
  std::optional<Eigen::Vector3d> target{};  ///< model units; absent: the rest position
};

/// Vertices that share one unknown map x_i = T p_i + t (FT05 section 7). T is any affine map, or scale ·
/// rotation for a similarity.
struct Feature {
  std::vector<Index> vertices{};
  bool similarity = false;
  std::optional<double> scale{};  ///< scale of a similarity; absent: it is solved for
};

}  // namespace meshgraft
