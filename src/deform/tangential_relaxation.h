#pragma once

#include <cstdint>
#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "decimate.h"

namespace meshgraft {

/// The surface that a coarse triangulation stands on.
struct FineSurface {
  const Points& points;
  const IndexLists& rings;
  std::span<const Index> group;          ///< of each vertex: coarse vertices stay in theirs
  std::span<const std::uint8_t> locked;  ///< coarse vertices that stay where they are
};

/// Makes the triangles of a coarse triangulation as equilateral as may be: coarse vertices step over the
/// surface to the vertex nearest to the middle of their ring, edges are flipped to Delaunay; `rounds` times.
void relax_tangentially(const FineSurface& surface, Decimated& coarse, int rounds, const Context& context = {});

}  // namespace meshgraft
