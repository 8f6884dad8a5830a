#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "part.h"

namespace meshgraft::distributed {

/// Returns the connected component of each local vertex that is flagged: the smallest of `names` in it, and -1
/// elsewhere. Vertices are connected along edges between flagged ones. `flagged` and `names` have an entry per
/// local vertex; the names are different from each other.
std::vector<Number> find_components(const Communicator& comm, const LocalMesh& mesh,
                                    std::span<const std::uint8_t> flagged, std::span<const Number> names);

/// Marks the transforms of connected components without a free position as known, and checks that the
/// constraints of all others fix an affine map. Throws Error(unsolvable) on all ranks, as `require_solvable`
/// does for a mesh on one machine.
void fix_and_require_solvable(const Communicator& comm, Part& part);

}  // namespace meshgraft::distributed
