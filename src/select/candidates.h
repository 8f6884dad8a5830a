#pragma once

#include <vector>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/select/selection.h>

namespace meshgraft {

/// Returns the vertices that belong to a face and have finite positions, ascending.
std::vector<Index> candidates_of(const SelectionMesh& context);

}  // namespace meshgraft
