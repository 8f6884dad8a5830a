#pragma once

#include <array>
#include <vector>

#include "support/hole_families.h"

namespace meshgraft::test {

/// The triangles of a hole by CGAL's triangulate_hole_polyline; empty where it finds none.
std::vector<std::array<Index, 3>> cgal_hole_triangles(const HoleCase& hole);

}  // namespace meshgraft::test
