#include "support/cgal_holes.h"

#include <iterator>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

namespace meshgraft::test {

std::vector<std::array<Index, 3>> cgal_hole_triangles(const HoleCase& hole) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto points_of = [](const Points& points) {
    std::vector<Kernel::Point_3> list;
    for (const auto& point : points.rowwise()) list.emplace_back(point[0], point[1], point[2]);
    return list;
  };
  std::vector<CGAL::Triple<int, int, int>> found;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points_of(hole.points), points_of(hole.beyond),
                                                           std::back_inserter(found));
  std::vector<std::array<Index, 3>> triangles;
  for (const auto& t : found) triangles.push_back({t.first, t.second, t.third});
  return triangles;
}

}  // namespace meshgraft::test
