#pragma once

#include <array>
#include <optional>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Triangles over a closed polyline (k×3, k > 3), as places in it, wound as it runs: those with the smallest
/// largest angle between neighbours, then the smallest area. `beyond` (k×3) has for each edge from a point to
/// the next the corner of the face on its other side. Empty where there are none, or where the build cannot (no
/// CGAL).
std::vector<std::array<Index, 3>> triangulate_hole(const Points& polyline, const Points& beyond);

}  // namespace meshgraft
