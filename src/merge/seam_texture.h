#pragma once

#include <span>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Gives the corners of a strip texture coordinates that continue those of the target. `first_new` is the first
/// face of the strip; `neighbour`, per triangle of it, the target's face beside it. At a vertex of the target
/// the neighbour's own coordinates are taken, at one of the source they are extrapolated, averaged over the
/// triangles of one chart. A triangle beside a face without coordinates has none.
void continue_texture(Mesh& mesh, Index first_new, std::span<const Index> neighbour);

}  // namespace meshgraft
