#pragma once

#include <optional>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"

namespace meshgraft {

/// Per vertex the number of fans: groups of faces around it that hang together by edges at it. 0 for an
/// isolated vertex, 1 on a manifold.
std::vector<Index> fan_counts(const Mesh& mesh, const EdgeTable& table);

/// Whether the two faces at an edge run along it in opposite directions; empty if there are not two.
std::optional<bool> consistently_oriented(const Mesh& mesh, const EdgeTable& table, Index edge);

}  // namespace meshgraft
