#pragma once

#include <span>
#include <vector>

#include <meshgraft/merge/merge_options.h>

#include "loop_curve.h"
#include "pair_geometry.h"

namespace meshgraft {

/// A matched pair of vertices, as loop indices.
struct Knot {
  Index source = -1, target = -1;
  auto operator<=>(const Knot&) const = default;
};

/// Returns a loop parameter on the target per source loop vertex. Between matched vertices both loops are
/// parametrised by arc length (FT05 5.1). The target loop is traversed backwards.
std::vector<double> parameters_between(std::span<const Knot> knots, const LoopCurve& source,
                                       const LoopCurve& target);

/// Matches two loops from one pair of vertices (the start) or more, by arc length between them: FT05 5.1 (1)
/// and (2). Throws Error(input), naming the pair's location, for vertices that are not on the loops and for
/// matches that cross.
Correspondence match_by_arc_length(const PairGeometry& pair, std::span<const Match> matches);

}  // namespace meshgraft
