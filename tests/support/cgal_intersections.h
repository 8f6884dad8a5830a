#pragma once

#include <array>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// Three corners of a triangle.
using Corners = std::array<std::array<double, 3>, 3>;

/// What CGAL's kernel with exact predicates says: whether the corners are not collinear, and whether two closed
/// triangles with area have more in common than the first `shared` corners of both.
bool cgal_has_area(const Corners& t);
bool cgal_intersect(const Corners& a, const Corners& b, int shared);

/// The pairs of triangles with area that have more in common than vertices and edges that they share, in
/// lexicographic order: a test of all pairs.
std::vector<std::array<Index, 2>> cgal_self_intersections(const Points& points, const Triangles& triangles);

}  // namespace meshgraft::test
