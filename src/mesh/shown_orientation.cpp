#include "mesh/shown_orientation.h"

#include <algorithm>

#include "mesh/up_axis.h"

namespace meshgraft {

namespace {

// This bound sets 10 of 14 samples and scans with z up upright in a format whose convention is y, and turns
// none of 17 with y up.
constexpr double clear_probability = 0.85;

const Eigen::Vector3d& direction_of(UpAxis axis) {
  static const Eigen::Vector3d y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  return axis == UpAxis::y ? y : z;
}

Eigen::Vector3d upper_side(const Mesh& mesh, const std::vector<OrientationGuess>& guesses) {
  const UprightSource* source = upright_source(mesh);
  if (source != nullptr && source->stated_up_axis()) return direction_of(*source->stated_up_axis());
  for (const UpAxis axis : {UpAxis::y, UpAxis::z}) {
    double probability = 0;
    for (const OrientationGuess& guess : guesses)
      if (guess.orientation.up.isApprox(direction_of(axis))) probability += guess.probability;
    if (probability > clear_probability) return direction_of(axis);
  }
  return direction_of(up_axis_of(mesh));
}

}  // namespace

Orientation shown_orientation(const Mesh& mesh) {
  const std::vector<OrientationGuess> guesses = guess_orientations(mesh);
  const Eigen::Vector3d up = upper_side(mesh, guesses);
  const auto is_upright = [&](const OrientationGuess& guess) { return guess.orientation.up.isApprox(up); };
  return std::ranges::find_if(guesses, is_upright)->orientation;  // there are four for each upper side
}

}  // namespace meshgraft
