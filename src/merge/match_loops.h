#pragma once

#include <span>
#include <vector>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

#include "match_automatically.h"
#include "pair_geometry.h"

namespace meshgraft {

/// Returns the geometry of the pairs' loops, smoothed along themselves if `smooth` is set.
std::vector<PairGeometry> pair_geometry(const Mesh& target, const Mesh& source, std::span<const LoopPair> pairs,
                                        bool smooth);

/// Returns the indices of the pairs of each connected component of the source that has any. `component` is
/// per vertex.
std::vector<std::vector<std::size_t>> pairs_by_component(std::span<const PairGeometry> pairs,
                                                         const std::vector<Index>& component);

/// Returns one correspondence per pair. It follows the matches given for the pair where there are any. Else it
/// is found automatically, for each component of the source over all its pairs without matches. With `posed`
/// the source is already in its pose.
std::vector<Correspondence> match_loops(std::span<const PairGeometry> pairs, std::span<const MergePair> given,
                                        const std::vector<Index>& component, bool posed,
                                        const ModelOrientations& orientations);

}  // namespace meshgraft
