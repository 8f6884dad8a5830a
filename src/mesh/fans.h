#pragma once

#include <optional>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"

namespace meshgraft {

/// Returns per vertex the number of fans: groups of faces around it that are connected by edges at the
/// vertex. The number is 0 for an isolated vertex and 1 on a manifold.
std::vector<Index> fan_counts(const Mesh& mesh, const EdgeTable& table);

/// Returns whether the two faces at an edge traverse it in opposite directions, or nothing if there are not
/// two.
std::optional<bool> consistently_oriented(const Mesh& mesh, const EdgeTable& table, Index edge);

}  // namespace meshgraft
