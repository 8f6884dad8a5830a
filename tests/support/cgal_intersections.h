#pragma once

#include <array>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// The three corners of a triangle.
using Corners = std::array<std::array<double, 3>, 3>;

/// The functions use CGAL's kernel with exact predicates. `cgal_has_area` returns whether the corners are not
/// collinear. `cgal_intersect` returns whether two closed triangles with area have more in common than the
/// first `shared` corners of both.
bool cgal_has_area(const Corners& t);
bool cgal_intersect(const Corners& a, const Corners& b, int shared);

/// Returns the pairs of triangles with area that have more in common than shared vertices and edges, in
/// lexicographic order. Tests all pairs.
std::vector<std::array<Index, 2>> cgal_self_intersections(const Points& points, const Triangles& triangles);

}  // namespace meshgraft::test
