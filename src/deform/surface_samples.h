#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Vertices spread evenly over a part of a surface: each the farthest, along edges, from those before it and
/// from the seeds. Every part that the seeds do not reach gets one first, so there may be more than `count`;
/// fewer where there are no more places. `seeds` and `candidates` are flags per vertex.
std::vector<Index> farthest_vertices(const Points& points, const IndexLists& rings,
                                     std::span<const std::uint8_t> seeds,
                                     std::span<const std::uint8_t> candidates, Index count);

/// Of each vertex the number of the nearest sample along edges, -1 where none is connected.
std::vector<Index> nearest_sample(const Points& points, const IndexLists& rings,
                                  std::span<const Index> samples);

}  // namespace meshgraft
