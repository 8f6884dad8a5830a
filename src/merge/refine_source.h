#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A source that is fine enough at its loops to be merged.
struct RefinedSource {
  Mesh mesh;                    ///< the vertices as given, then those that were added
  std::vector<LoopPair> pairs;  ///< the loops with their added vertices
  Index added = 0;
};

/// Halves the source's edges near its loops. Around loops that are coarser than their target loops this is
/// done until the target's edges are at least 1/edge_ratio times as long as the source's. With `refine_radius`
/// it is done within each loop's radius until the source can bend there.
RefinedSource refine_source(Mesh source, std::vector<LoopPair> pairs, const SeamOptions& options,
                            const Context& context);

}  // namespace meshgraft
