#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "local_mesh.h"

namespace meshgraft::distributed {

/// Divides the flagged vertices of a mesh among the ranks, in parts of about equal size with short borders
/// (PT-Scotch). Returns the new rank of each own vertex, -1 for vertices that are not flagged. `flagged` has a
/// flag for each local vertex. Fewer than 200 vertices per rank are divided in the order of their numbers.
std::vector<int> partition_vertices(const Communicator& comm, const LocalMesh& mesh,
                                    std::span<const std::uint8_t> flagged);

}  // namespace meshgraft::distributed
