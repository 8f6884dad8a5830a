#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Returns vertices spread over a part of a surface, twice as densely beside the seeds as at the vertex
/// farthest from them. Each is the candidate farthest, along edges and by that measure, from those before it
/// and from the seeds. Each component without seeds gets one first, so there may be more than `count`. There
/// are fewer if no distinct candidates are left. `seeds` and `candidates` are flags per vertex.
std::vector<Index> farthest_vertices(const Points& points, const IndexLists& rings,
                                     std::span<const std::uint8_t> seeds,
                                     std::span<const std::uint8_t> candidates, Index count,
                                     const Context& context = {});

/// Returns for each vertex the index of the nearest sample along edges, or -1 if none is connected.
std::vector<Index> nearest_sample(const Points& points, const IndexLists& rings, std::span<const Index> samples,
                                  const Context& context = {});

}  // namespace meshgraft
