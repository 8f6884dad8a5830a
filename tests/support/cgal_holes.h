#pragma once

#include <array>
#include <vector>

#include "support/hole_families.h"

namespace meshgraft::test {

/// Returns the triangles of a hole by CGAL's triangulate_hole_polyline, or none if it finds none.
std::vector<std::array<Index, 3>> cgal_hole_triangles(const HoleCase& hole);

}  // namespace meshgraft::test
