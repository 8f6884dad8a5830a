// Hole triangulation beside CGAL's, which is seen by tests and benchmarks alone.

#include <gtest/gtest.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "mesh/hole_triangulation.h"
#include "support/hole_families.h"

namespace meshgraft {
namespace {

std::vector<HoleTriangle> cgal_triangles(const test::HoleCase& hole) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto points_of = [](const Points& points) {
    std::vector<Kernel::Point_3> list;
    for (const auto& point : points.rowwise()) list.emplace_back(point[0], point[1], point[2]);
    return list;
  };
  std::vector<CGAL::Triple<int, int, int>> found;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points_of(hole.points), points_of(hole.beyond),
                                                           std::back_inserter(found));
  std::vector<HoleTriangle> triangles;
  for (const auto& t : found) triangles.push_back({t.first, t.second, t.third});
  return triangles;
}

TEST(HoleTriangulation, IsAsGoodAsCgals) {
  for (const test::HoleCase& hole : test::hole_cases(300)) {
    SCOPED_TRACE(hole.name());
    const test::HoleCost ours = hole_cost(hole, triangulate_hole({hole.points, hole.beyond}));
    const std::vector<HoleTriangle> theirs = cgal_triangles(hole);
    if (theirs.empty()) continue;
    const test::HoleCost cgal = hole_cost(hole, theirs);
    EXPECT_LE(ours.angle, cgal.angle + 1e-9);
    if (ours.angle > cgal.angle - 1e-9) {
      EXPECT_LE(ours.area, cgal.area * (1 + 1e-9));
    }
  }
}

}  // namespace
}  // namespace meshgraft
