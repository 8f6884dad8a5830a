#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Directions of a model in its own coordinates: away from the ground, and the way it faces. Unit vectors at a
/// right angle.
struct Orientation {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), front = -Eigen::Vector3d::UnitY();
};

/// An orientation that a model may have.
struct OrientationGuess {
  Orientation orientation;
  double probability = 1;
};

/// Returns the direction of an axis by its name, such as "z" or "-y"; nothing for other names.
std::optional<Eigen::Vector3d> axis_named(std::string_view name);

/// Returns the orientation with these directions, of any length; `front` loses its part along `up`. Throws
/// Error(input) with the id mesh.orientation_undefined where one has no length or both are parallel.
Orientation make_orientation(const Eigen::Vector3d& up, const Eigen::Vector3d& front);

/// Returns all 24 orientations along the coordinate axes, the most probable one first. Probabilities add up
/// to 1. A model is taken to have its mirror plane across its side, to stand on a wide base (Fu et al. 2008,
/// upright orientation), to lean forward if it is closed, and to follow a convention more often than not: y or
/// z up, and front z with y up, −y with z up. Give the whole model: a piece of it tells less.
std::vector<OrientationGuess> guess_orientations(const Mesh& mesh);

}  // namespace meshgraft
