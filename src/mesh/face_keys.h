#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns groups of two or more faces with the same corners in the same cyclic order, in either direction.
/// Each group is ascending, and groups are ordered by their first face. `number` renames the vertices first,
/// unless it is empty. Faces with an index out of range or a repeated vertex are excluded.
std::vector<std::vector<Index>> same_faces(const Faces& faces, Index vertex_count,
                                           std::span<const Index> number = {});

}  // namespace meshgraft
