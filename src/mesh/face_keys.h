#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Groups of faces that have the same corners in the same cyclic order, in either direction, each of two faces
/// or more and ascending, in the order of their first one. `number` renames the vertices first (empty: as they
/// are). Faces with an index out of range or a vertex twice are in none.
std::vector<std::vector<Index>> same_faces(const Faces& faces, Index vertex_count,
                                           std::span<const Index> number = {});

}  // namespace meshgraft
