#include "hole_triangulation.h"

#include <exception>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>

#include <meshgraft/mesh/repair.h>

namespace meshgraft {

bool can_fill_holes() { return true; }

std::vector<std::array<Index, 3>> triangulate_hole(const Points& polyline, const Points& beyond) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto points_of = [](const Points& points) {
    std::vector<Kernel::Point_3> list;
    for (const auto& point : points.rowwise()) list.emplace_back(point[0], point[1], point[2]);
    return list;
  };
  std::vector<CGAL::Triple<int, int, int>> found;
  try {
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points_of(polyline), points_of(beyond),
                                                             std::back_inserter(found));
  } catch (const std::exception&) {
    return {};  // a failed assertion of CGAL's, for points that it does not expect
  }
  std::vector<std::array<Index, 3>> triangles;
  for (const auto& t : found) {
    std::array<Index, 3> corners{t.first, t.second, t.third};
    if (corners[0] > corners[1]) std::swap(corners[0], corners[1]);  // ascending is along the polyline
    if (corners[1] > corners[2]) std::swap(corners[1], corners[2]);
    if (corners[0] > corners[1]) std::swap(corners[0], corners[1]);
    triangles.push_back(corners);
  }
  return triangles;
}

}  // namespace meshgraft
