#pragma once

#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Moves vertices to the uniform means of their rings, all at once, `steps` times (FT05 section 5). Vertices
/// without a ring stay.
void smooth_by_umbrella(Points& points, const IndexLists& rings, std::span<const Index> moving, int steps,
                        const Context& context);

}  // namespace meshgraft
