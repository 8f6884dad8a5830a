#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Returns the unordered pairs of vertices that two faces with a common edge contain (SF of FT05 equation
/// 11). These are the edges and the pairs opposite across an edge; without `opposite` the edges alone. The
/// pairs are ascending, without repeats, and have at least one vertex in `active` (flags per vertex).
std::vector<std::array<Index, 2>> smoothness_pairs(const Triangles& triangles,
                                                   const IndexLists& vertex_triangles, const IndexLists& rings,
                                                   std::span<const std::uint8_t> active, bool opposite = true,
                                                   const Context& context = {});

}  // namespace meshgraft
