// Compares the library's intersection tests with CGAL's on the same pairs of triangles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <meshgraft/deform/quality.h>

#include "../../src/mesh/triangle_intersection.h"
#include "support/cgal_intersections.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

using Random = std::mt19937_64;

struct TrianglePairCase {
  Triangle3 a, b;
};

double uniform(Random& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }
int integer(Random& random, int least, int most) {
  return std::uniform_int_distribution<int>(least, most)(random);
}

template <class MakePoint>
TrianglePairCase made_of(const MakePoint& point) {
  TrianglePairCase pair;
  for (Triangle3* t : {&pair.a, &pair.b})
    for (Point3& p : *t) p = point();
  return pair;
}

// Returns a point in the plane of `t`, often on a corner or an edge's line. It is exact for small integers.
Point3 point_in_plane(const Triangle3& t, Random& random) {
  const int u = integer(random, -1, 5), v = integer(random, -1, 5 - u);
  Point3 p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = (u * t[0][k] + v * t[1][k] + (4 - u - v) * t[2][k]) / 4;
  return p;
}

TrianglePairCase on_grid(Random& random, int most) {
  return made_of([&] {
    Point3 p;
    for (double& x : p) x = integer(random, 0, most);
    return p;
  });
}

// Returns two triangles in the plane z = 0, in x + y + z = 0, or in a plane whose coordinates are rounded.
TrianglePairCase in_a_plane(Random& random) {
  const int kind = integer(random, 0, 2);
  return made_of([&]() -> Point3 {
    const double x = integer(random, 0, 6), y = integer(random, 0, 6);
    if (kind == 0) return {x, y, 0};
    if (kind == 1) return {x, y, -x - y};
    return {0.1 * x, 0.7 * y, 0.3 * (0.1 * x) + 0.9 * (0.7 * y)};
  });
}

// Returns triangles where one to three corners of the second lie in the plane of the first, mostly on it.
TrianglePairCase touching(Random& random) {
  TrianglePairCase pair = on_grid(random, 5);
  const int corners = integer(random, 1, 3);
  for (int k = 0; k < corners; ++k) pair.b[static_cast<std::size_t>(k)] = point_in_plane(pair.a, random);
  return pair;
}

// Returns triangles where an edge of the second is on the line of one of the first. Corners may coincide.
TrianglePairCase along_an_edge(Random& random) {
  TrianglePairCase pair = on_grid(random, 5);
  for (std::size_t corner = 0; corner < 2; ++corner) {
    const int t = integer(random, -2, 4);
    for (std::size_t k = 0; k < 3; ++k)
      pair.b[corner][k] = pair.a[0][k] + t * (pair.a[1][k] - pair.a[0][k]) / 2;
  }
  return pair;
}

TrianglePairCase of_mixed_exponents(Random& random) {
  return made_of([&]() -> Point3 {
    const auto number = [&] { return std::ldexp(uniform(random), -integer(random, 0, 80)); };
    return {number(), number(), number()};
  });
}

void for_each_coordinate(TrianglePairCase& pair, const std::function<double(double, std::size_t)>& change) {
  for (Triangle3* t : {&pair.a, &pair.b})
    for (Point3& p : *t)
      for (std::size_t k = 0; k < 3; ++k) p[k] = change(p[k], k);
}

void nudge(TrianglePairCase& pair, Random& random) {
  for_each_coordinate(pair, [&](double x, std::size_t) {
    const int way = integer(random, -2, 2);
    if (way % 2 == 0) return x;
    return std::nextafter(x, std::copysign(std::numeric_limits<double>::infinity(), way));
  });
}

struct Family {
  std::string name;
  std::function<TrianglePairCase(Random&)> make;
};

std::vector<Family> families() {
  std::vector<Family> all{
      {"random", [](Random& r) { return made_of([&] { return Point3{uniform(r), uniform(r), uniform(r)}; }); }},
      {"coarse grid", [](Random& r) { return on_grid(r, 2); }},
      {"fine grid", [](Random& r) { return on_grid(r, 6); }},
      {"coplanar", in_a_plane},
      {"touching", touching},
      {"along an edge", along_an_edge},
      {"mixed exponents", of_mixed_exponents}};
  const std::size_t plain = all.size();
  for (std::size_t k = 1; k < plain; ++k)
    all.push_back({all[k].name + ", nudged", [make = all[k].make](Random& r) {
                     TrianglePairCase pair = make(r);
                     nudge(pair, r);
                     return pair;
                   }});
  return all;
}

// Makes the first `shared` corners of both triangles equal; `intersect_beyond_shared` expects them first.
TrianglePairCase sharing(TrianglePairCase pair, int shared) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(shared); ++k) pair.b[k] = pair.a[k];
  return pair;
}

std::string text_of(const TrianglePairCase& pair) {
  std::string text;
  char number[40];
  for (const Triangle3* t : {&pair.a, &pair.b})
    for (const Point3& p : *t)
      for (const double x : p) text += (std::snprintf(number, sizeof number, "%a ", x), number);
  return text;
}

struct Tally {
  int pairs = 0, intersecting = 0;
};

void compare(const TrianglePairCase& pair, int shared, Tally& tally) {
  const bool areas = has_area(pair.a) && has_area(pair.b);
  ASSERT_EQ(areas, cgal_has_area(pair.a) && cgal_has_area(pair.b)) << text_of(pair);
  if (!areas) return;
  const bool intersect = intersect_beyond_shared(pair.a, pair.b, shared);
  ASSERT_EQ(intersect, cgal_intersect(pair.a, pair.b, shared)) << shared << " shared, " << text_of(pair);
  ASSERT_EQ(intersect, intersect_beyond_shared(pair.b, pair.a, shared)) << shared << ", " << text_of(pair);
  ++tally.pairs;
  tally.intersecting += intersect;
}

TEST(IntersectionsOracle, AgreesWithCgalOnPairsOfTriangles) {
  constexpr int cases = 10'000;
  Random random(20030601);
  Tally total;
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    for (int shared = 0; shared < 3; ++shared) {
      Tally tally;
      for (int k = 0; k < cases; ++k) {
        compare(sharing(family.make(random), shared), shared, tally);
        if (HasFatalFailure()) return;
      }
      EXPECT_GT(tally.pairs, cases / 3) << shared;
      if (shared < 2) {  // triangles that share an edge intersect only where they overlap in one plane
        EXPECT_GT(tally.intersecting, 0) << shared;
      }
      EXPECT_LT(tally.intersecting, tally.pairs) << shared;
      total.pairs += tally.pairs;
    }
  }
  EXPECT_GT(total.pairs, 200'000);
}

TEST(IntersectionsOracle, AgreesWithCgalWhereProductsUnderflowAndOverflow) {
  constexpr int cases = 150;
  Random random(7);
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    for (const std::array<double, 3> size :
         {std::array{1e-200, 1e-200, 1e-200}, {1e150, 1e150, 1e150}, {1e-300, 1.0, 1e-9}, {1e150, 1e-150, 1.0}})
      for (int shared = 0; shared < 3; ++shared)
        for (int k = 0; k < cases; ++k) {
          TrianglePairCase pair = family.make(random);
          for_each_coordinate(pair, [&](double x, std::size_t axis) { return size[axis] * x; });
          Tally tally;
          compare(sharing(pair, shared), shared, tally);
          if (HasFatalFailure()) return;
        }
  }
}

std::vector<Index> all_vertices(const Points& points) {
  std::vector<Index> all(static_cast<std::size_t>(points.rows()));
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

TEST(IntersectionsOracle, AgreesWithCgalOnCrumpledSurfaces) {
  Random random(11);
  for (TestMesh mesh : small_families()) {
    const double step = mesh.box_diagonal() / 20;
    for (const bool snapped : {false, true}) {
      SCOPED_TRACE(mesh.name + (snapped ? ", snapped to a grid" : ""));
      Points crumpled = mesh.positions;
      for (double& x : crumpled.reshaped()) x += 2 * step * uniform(random);
      if (snapped)
        for (double& x : crumpled.reshaped()) x = step * std::round(x / step);
      EXPECT_EQ(self_intersections(crumpled, mesh.triangles, all_vertices(crumpled)),
                cgal_self_intersections(crumpled, mesh.triangles));
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
