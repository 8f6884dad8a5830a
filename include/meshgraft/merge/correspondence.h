#pragma once

#include <cstddef>
#include <vector>

#include <meshgraft/core/fact.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A source loop and the target loop it meets (FT05 section 5). Each lists all vertices of a boundary loop,
/// from any vertex on. Their order is the direction of their own mesh's half-edges (surface on the left, seen
/// from outside), so that the two loops run opposite ways.
struct LoopPair {
  std::vector<Index> source, target;
};

/// A source loop vertex and the target loop vertex it meets.
struct Match {
  Index source = -1, target = -1;
};

/// A pair whose loops fit about as well from several starts.
struct OpenStart {
  std::size_t pair = 0;  ///< index of the pair
  /// The start that turns the source least from its given pose, as vertices of the meshes.
  Match least_turned;
  double confidence = 0;  ///< 0 … 1, confidence of the start that fits best
};

/// Returns the ambiguous pairs that a fact merge.open_start lists, at least one, in the order of pairs. Throws
/// std::out_of_range for other facts.
std::vector<OpenStart> open_starts(const Fact& fact);

}  // namespace meshgraft
