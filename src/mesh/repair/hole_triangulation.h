#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "hole_search.h"

namespace meshgraft {

struct HoleTriangulationOptions {
  /// Edges that the surface already has between vertices of the loop, smaller index first; they are not made
  /// again. Edges of the loop itself are ignored.
  std::vector<HoleChord> forbidden{};
  /// Loops of at most this many edges are searched in full, larger ones from coarse to fine. A full search
  /// takes O(n³): 0.1 s for 200 edges, up to 50 s for 500.
  Index full_search = 200;
};

/// Triangulates a closed polyline of n ≥ 3 points with n − 2 triangles, oriented along it. Minimises the
/// largest angle between the normals of neighbouring triangles, including the faces beyond the loop, and then
/// the area (after Barequet & Sharir 1995 and Liepa 2003). Avoids triangles without area if possible.
///
/// The result is optimal for loops of up to `full_search` edges. For larger loops it is the best one near
/// that of a coarser loop, which is nearly always as good. Returns no triangles if points are not finite or
/// the forbidden edges allow none. The result does not depend on the number of threads. Throws
/// Error(cancelled).
std::vector<HoleTriangle> triangulate_hole(const HoleLoop& loop, const HoleTriangulationOptions& options = {},
                                           const Context& context = {});

}  // namespace meshgraft
