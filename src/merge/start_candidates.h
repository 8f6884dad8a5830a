#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/orientation.h>

namespace meshgraft {

/// The fit of two loops where the source's start meets one of equally spaced points of the target's loop.
struct LoopFit {
  /// 0 where a similarity maps the loops onto one another; at most 2. `cost` counts their normals, too.
  double cost = 0, point_cost = 0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< of that similarity, source → target
  bool coincides = false;                                  ///< whether all vertices come to meet vertices
};

/// Orientations that the mesh around a loop may have, and the direction from its target's loop into its source.
struct LoopOrientations {
  std::vector<OrientationGuess> guesses;
  Eigen::Vector3d into_source = Eigen::Vector3d::UnitZ();
};

/// A start, as an index of the fits.
struct RankedShift {
  int shift = 0;
  double probability = 0;
};

/// Returns the starts that a person would choose, at most five, the most probable first. A person brings up to
/// up and front to front, as far as the loops allow; loops of one shape are the two sides of one cut. A start
/// stands for those within a tenth of a turn.
std::vector<RankedShift> rank_starts(std::span<const LoopFit> fits, const LoopOrientations& source,
                                     const LoopOrientations& target);

/// Returns whether the first of the starts is too improbable to be taken for granted.
bool is_unsure(std::span<const StartCandidate> starts);

}  // namespace meshgraft
