#include "../../src/mesh/triangle_intersection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace meshgraft::test {
namespace {

using Random = std::mt19937_64;

struct Pair {
  Triangle3 a, b;
};

// Returns pairs of triangles with area and small integer corners, so that all ways to touch occur often.
std::vector<Pair> pairs_on_grids() {
  Random random(8);
  std::vector<Pair> pairs;
  for (const int most : {1, 2, 4, 9}) {
    std::uniform_int_distribution<int> coordinate(0, most);
    for (int k = 0; k < 1000; ++k) {
      Pair pair;
      for (Triangle3* t : {&pair.a, &pair.b})
        for (Point3& p : *t)
          for (double& x : p) x = coordinate(random);
      if (has_area(pair.a) && has_area(pair.b)) pairs.push_back(pair);
    }
  }
  return pairs;
}

Triangle3 moved(Triangle3 t, const Point3& by) {
  for (Point3& p : t)
    for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
  return t;
}

const Triangle3 base{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(HasArea, NeedsThreeFiniteCornersThatAreNotCollinear) {
  EXPECT_TRUE(has_area(base));
  EXPECT_FALSE(has_area({{{1, 2, 3}, {1, 2, 3}, {4, 5, 7}}}));
  EXPECT_FALSE(has_area({{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}}));
  EXPECT_TRUE(has_area({{{0, 0, 0}, {1, 2, 3}, {2, 4, std::nextafter(6, 7)}}}));
  EXPECT_TRUE(has_area({{{0, 0, 0}, {1e-300, 0, 0}, {0, 0, 1e-300}}}));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(has_area({{{0, 0, 0}, {1, 0, 0}, {0, 1, bad}}}));
}

TEST(TrianglesIntersect, KnownPositions) {
  struct Case {
    const char* name;
    Triangle3 other;
    bool expected;
  };
  constexpr double ulp = 0x1p-1074;
  for (const Case& c : {Case{"through the face", {{{1, 1, -1}, {1, 1, 1}, {2, 2, 1}}}, true},
                        {"a corner on the face", {{{1, 1, 0}, {1, 1, 1}, {2, 2, 1}}}, true},
                        {"a corner just above", {{{1, 1, ulp}, {1, 1, 1}, {2, 2, 1}}}, false},
                        {"a corner on an edge", {{{2, 0, 0}, {2, -1, 1}, {3, -1, 1}}}, true},
                        {"a corner at a corner", {{{4, 0, 0}, {5, 0, 1}, {5, 1, 1}}}, true},
                        {"past a corner", {{{4, 0.5, -1}, {4, 0.5, 1}, {6, 0.5, 0}}}, false},
                        {"edges cross", {{{2, -1, -1}, {2, 1, 1}, {2, -5, 5}}}, true},
                        {"beside, in one plane", {{{5, 0, 0}, {6, 0, 0}, {5, 3, 0}}}, false},
                        {"along the long edge, in one plane", {{{4, 1, 0}, {1, 4, 0}, {4, 4, 0}}}, false},
                        {"on the long edge, in one plane", {{{3, 1, 0}, {1, 3, 0}, {4, 4, 0}}}, true},
                        {"within, in one plane", {{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}}, true},
                        {"around, in one plane", {{{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}}, true},
                        {"a star, in one plane", {{{-1, 1, 0}, {3, -1, 0}, {3, 3, 0}}}, true},
                        {"a corner in common, in one plane", {{{4, 0, 0}, {8, 0, 0}, {8, 4, 0}}}, true},
                        {"above", {{{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}}, false}}) {
    EXPECT_EQ(triangles_intersect(base, c.other), c.expected) << c.name;
    EXPECT_EQ(triangles_intersect(c.other, base), c.expected) << c.name;
  }
}

TEST(TrianglesIntersect, NeitherOrderNorWindingMatters) {
  int intersecting = 0;
  const std::vector<Pair> pairs = pairs_on_grids();
  for (const auto& [a, b] : pairs) {
    const bool expected = triangles_intersect(a, b);
    intersecting += expected;
    std::array<std::size_t, 3> order{0, 1, 2};
    do {
      const Triangle3 turned{a[order[0]], a[order[1]], a[order[2]]};
      ASSERT_EQ(triangles_intersect(turned, b), expected);
      ASSERT_EQ(triangles_intersect(b, turned), expected);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  EXPECT_GT(intersecting, 300);
  EXPECT_LT(intersecting, static_cast<int>(pairs.size()) - 300);
}

TEST(TrianglesIntersect, PartsOfATriangleIntersectWhatTheWholeDoes) {
  // A triangle that is split at the middle of an edge is the union of its two closed halves.
  for (const auto& [a, b] : pairs_on_grids()) {
    Point3 middle;
    for (std::size_t k = 0; k < 3; ++k) middle[k] = (a[0][k] + a[1][k]) / 2;
    ASSERT_EQ(triangles_intersect(a, b),
              triangles_intersect({a[0], middle, a[2]}, b) || triangles_intersect({middle, a[1], a[2]}, b));
  }
}

TEST(TrianglesIntersect, WhatHasACornerInCommonDoes) {
  for (auto [a, b] : pairs_on_grids()) {
    b = moved(b, {a[1][0] - b[2][0], a[1][1] - b[2][1], a[1][2] - b[2][2]});
    ASSERT_TRUE(triangles_intersect(a, b));
  }
}

TEST(TrianglesIntersect, MovedBeyondTheirSizeTheyDoNot) {
  for (const auto& [a, b] : pairs_on_grids())
    for (std::size_t k = 0; k < 3; ++k) {
      Point3 by{};
      by[k] = 10;
      ASSERT_FALSE(triangles_intersect(a, moved(b, by)));
    }
}

TEST(IntersectBeyondShared, WholeTrianglesInCommonAreNone) {
  EXPECT_FALSE(intersect_beyond_shared(base, base, 3));
}

TEST(IntersectBeyondShared, OverASharedEdgeOnlyAFoldOntoItselfCounts) {
  const auto across = [](const Point3& p) { return intersect_beyond_shared(base, {base[0], base[1], p}, 2); };
  EXPECT_FALSE(across({1, -3, 0})) << "flat";
  EXPECT_FALSE(across({1, 2, 0x1p-1074})) << "nearly closed";
  EXPECT_TRUE(across({1, 2, 0})) << "closed";
  EXPECT_TRUE(across({9, 9, 0})) << "beyond";
}

TEST(IntersectBeyondShared, AroundASharedCornerWhatLiesBeyondItCounts) {
  const auto around = [](const Point3& p, const Point3& q) {
    return intersect_beyond_shared(base, {base[0], p, q}, 1);
  };
  EXPECT_FALSE(around({-1, 0, 1}, {-1, 0, -1}));
  EXPECT_FALSE(around({1, 1, 1}, {2, 1, 1}));
  EXPECT_TRUE(around({1, 1, 1}, {1, 1, -1})) << "through the face";
  EXPECT_TRUE(around({9, 9, 1}, {9, 9, -1})) << "through the far side";
  EXPECT_TRUE(around({1, 0, 0}, {1, -1, -1})) << "along an edge";
  EXPECT_TRUE(around({8, 0, 0}, {1, -1, -1})) << "along an edge and beyond";
  EXPECT_FALSE(around({-1, 0, 0}, {1, -1, -1})) << "along an edge, away from it";
  EXPECT_TRUE(around({5, -1, 0}, {5, 9, 0})) << "wider, in one plane";
  EXPECT_FALSE(around({-4, 1, 0}, {-4, -1, 0})) << "across, in one plane";
}

TEST(IntersectBeyondShared, NeitherOrderNorWindingMatters) {
  int intersecting = 0, all = 0;
  for (auto [a, b] : pairs_on_grids()) {
    b[0] = a[0];
    if (!has_area(b)) continue;
    const bool expected = intersect_beyond_shared(a, b, 1);
    intersecting += expected;
    ++all;
    ASSERT_EQ(intersect_beyond_shared(b, a, 1), expected);
    ASSERT_EQ(intersect_beyond_shared(a, {b[0], b[2], b[1]}, 1), expected);
    ASSERT_EQ(intersect_beyond_shared({a[0], a[2], a[1]}, b, 1), expected);
  }
  EXPECT_GT(intersecting, 100);
  EXPECT_LT(intersecting, all - 100);
}

}  // namespace
}  // namespace meshgraft::test
