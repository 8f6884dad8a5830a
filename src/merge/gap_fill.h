#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "seam.h"

namespace meshgraft {

/// One side of a gap: a loop and the surface beyond it.
struct GapSide {
  std::vector<Index> loop;  ///< vertices in the order in which the strip passes them
  Points points;            ///< k×3, of the loop
  Points face_normals;      ///< k×3: row i is the unit normal of the face beyond the edge from i to i + 1
};

/// Returns the triangles that fill the gap between two loops. Both loops run in the same direction: the first
/// along its mesh's half-edges, the second against them. Each triangle has an edge of one loop and a vertex
/// of the other.
std::vector<std::array<Index, 3>> fill_gap(const GapSide& first, const GapSide& second, StripMethod method,
                                           const Context& context);

}  // namespace meshgraft
