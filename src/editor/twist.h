#pragma once

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::editor {

/// Returns the start that is turned from `start` by an angle along the target's loop. It is the pair of
/// vertices of both boundary loops that comes nearest to the angle, so that coarse loops can be turned
/// finely, too. `mirrored`: the graft mirrors the source, whose loop then runs as the target's does. Throws
/// Error(input) where `start` is on no boundary loop.
Match twisted_start(const Mesh& source, const Mesh& target, const Match& start, double by_deg,
                    bool mirrored = false);

}  // namespace meshgraft::editor
