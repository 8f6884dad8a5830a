#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/orientation.h>

#include "pair_geometry.h"

namespace meshgraft {

/// Orientations that the two models may have, in their own coordinates.
struct ModelOrientations {
  std::vector<OrientationGuess> target, source;
};

/// Finds the start of each pair. The pairs belong to one connected source. Several pairs share a similarity,
/// which their centres, their axes and the shapes of distinguished loops determine. A single pair starts where
/// a person would start it, and its correspondence lists the most probable starts (`rank_starts`). With `posed`
/// the source is already in its pose, and nearness decides.
std::vector<Correspondence> match_automatically(std::span<const PairGeometry> pairs, bool posed,
                                                const ModelOrientations& orientations);

}  // namespace meshgraft
