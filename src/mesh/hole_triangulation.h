#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "hole_search.h"

namespace meshgraft {

struct HoleTriangulationOptions {
  /// Edges that the surface has already between vertices of the loop, the smaller index of each first: they are
  /// not made again. Edges of the loop do not count.
  std::vector<HoleChord> forbidden{};
  /// Loops of at most this many edges are searched in full; larger ones from coarse to fine. A full search
  /// takes O(n³): 0.1 s for 200 edges, up to 50 s for 500.
  Index full_search = 200;
};

/// Triangulates a closed polyline of n ≥ 3 points: n − 2 triangles, wound as it runs. The largest angle between
/// the normals of neighbouring triangles, the faces beyond the loop included, is the smallest possible, and the
/// area then the smallest (after Barequet & Sharir 1995 and Liepa 2003). Triangles without area are avoided
/// where that can be. The optimum for loops of up to `full_search` edges; for larger ones the best near that of
/// a coarser loop, which is nearly always as good. Empty for points that are not finite, and where forbidden
/// edges leave nothing. The result does not depend on the number of threads. Throws Error(cancelled).
std::vector<HoleTriangle> triangulate_hole(const HoleLoop& loop, const HoleTriangulationOptions& options = {},
                                           const Context& context = {});

}  // namespace meshgraft
