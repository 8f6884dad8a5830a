// Compares hole triangulation with CGAL's, which only tests and benchmarks use.

#include <gtest/gtest.h>

#include "mesh/repair/hole_triangulation.h"
#include "support/cgal_holes.h"
#include "support/hole_families.h"

namespace meshgraft {
namespace {

TEST(HoleTriangulation, IsAsGoodAsCgals) {
  for (const test::HoleCase& hole : test::hole_cases(600)) {
    SCOPED_TRACE(hole.name());
    const test::HoleCost ours = hole_cost(hole, triangulate_hole({hole.points, hole.beyond}));
    const std::vector<HoleTriangle> theirs = test::cgal_hole_triangles(hole);
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
