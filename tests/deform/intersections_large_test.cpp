// Where triangles crowd, the search for intersections ends instead of taking quadratic time.
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include <meshgraft/deform/intersections.h>

namespace meshgraft::test {
namespace {

// `count` triangles that lie on top of each other, parallel and apart.
std::optional<std::vector<TrianglePair>> intersections_of_a_stack(Index count) {
  Points points(3 * count, 3);
  Triangles triangles(count, 3);
  for (Index t = 0; t < count; ++t) {
    const double z = 1e-6 * t;
    points.middleRows(3 * t, 3) << 0, 0, z, 1, 0, z + 1, 0, 1, z + 1;
    triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  std::vector<Index> free(static_cast<std::size_t>(3 * count));
  std::iota(free.begin(), free.end(), Index{0});
  return self_intersections(points, triangles, free);
}

TEST(IntersectionsLarge, ACrowdIsNotCountedToItsEnd) {
  const auto few = intersections_of_a_stack(2000);
  if (!few) GTEST_SKIP() << "built without CGAL";
  EXPECT_TRUE(few->empty());
  EXPECT_FALSE(intersections_of_a_stack(100'000).has_value());
}

}  // namespace
}  // namespace meshgraft::test
