#pragma once

#include <cstdint>
#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "decimate.h"

namespace meshgraft {

/// The fine surface whose vertices a coarse triangulation uses.
struct FineSurface {
  const Points& points;
  const IndexLists& rings;
  std::span<const Index> group;          ///< per vertex: coarse vertices stay in their group
  std::span<const std::uint8_t> locked;  ///< per vertex: a coarse vertex here does not move
};

/// Makes the triangles of a coarse triangulation more equilateral, in `rounds` rounds. Each round moves
/// coarse vertices over the surface to the vertex nearest to the centre of their ring, and flips edges to
/// Delaunay.
void relax_proxy(const FineSurface& surface, Decimated& coarse, int rounds, const Context& context = {});

}  // namespace meshgraft
