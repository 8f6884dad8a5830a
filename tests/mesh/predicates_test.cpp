#include "../../src/mesh/predicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace meshgraft::test {
namespace {

using Random = std::mt19937_64;
using Points4 = std::array<Point3, 4>;

int orient3d(const Points4& p) { return meshgraft::orient3d(p[0], p[1], p[2], p[3]); }
int fixed_point_orient3d(const Points4& p) { return meshgraft::fixed_point_orient3d(p[0], p[1], p[2], p[3]); }
int exact_orient3d(const Points4& p) { return meshgraft::exact_orient3d(p[0], p[1], p[2], p[3]); }

int sign_of(std::int64_t value) { return (value > 0) - (value < 0); }

// Returns the sign of orient3d, exactly, for points with integer coordinates below 2^19.
int integer_orient3d(const Points4& p) {
  std::array<std::array<std::int64_t, 3>, 3> m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) m[i][k] = static_cast<std::int64_t>(p[i + 1][k] - p[0][k]);
  return sign_of(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                 m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                 m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

double integer(Random& random, int most) { return std::uniform_int_distribution<int>(-most, most)(random); }
double uniform(Random& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }

Points4 integers(Random& random, int most) {
  Points4 p;
  for (Point3& q : p)
    for (double& x : q) x = integer(random, most);
  return p;
}

// Returns three random points and a fourth in their plane, up to rounding.
Points4 nearly_coplanar(Random& random) {
  Points4 p;
  for (Point3& q : p)
    for (double& x : q) x = uniform(random);
  const double s = uniform(random), t = uniform(random);
  for (std::size_t k = 0; k < 3; ++k) p[3][k] = p[0][k] + s * (p[1][k] - p[0][k]) + t * (p[2][k] - p[0][k]);
  return p;
}

Points4 of_mixed_exponents(Random& random, int range) {
  Points4 p;
  for (Point3& q : p)
    for (double& x : q) x = std::ldexp(uniform(random), static_cast<int>(integer(random, range)));
  return p;
}

Points4 scaled(Points4 p, const std::array<int, 3>& exponents) {
  for (Point3& q : p)
    for (std::size_t k = 0; k < 3; ++k) q[k] = std::ldexp(q[k], exponents[k]);
  return p;
}

TEST(Orient2d, TurnsToTheLeft) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient2d({0, 0}, {1, 2}, {2, 4}), 0);
}

TEST(Orient3d, SeesTheTriangleCounterClockwiseFromItsPositiveSide) {
  EXPECT_EQ(meshgraft::orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(meshgraft::orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
  EXPECT_EQ(meshgraft::orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, -3, 0}), 0);
}

TEST(Orient2d, IsExactForIntegers) {
  Random random(1);
  int zeros = 0;
  for (const int most : {1, 3, 1000, 1 << 30})
    for (int k = 0; k < 5000; ++k) {
      std::array<Point2, 3> p;
      for (Point2& q : p) q = {integer(random, most), integer(random, most)};
      if (k % 3 == 0) p[2] = {2 * p[1][0] - p[0][0], 2 * p[1][1] - p[0][1]};
      const auto d = [&](std::size_t i, std::size_t axis) {
        return static_cast<std::int64_t>(p[i][axis] - p[0][axis]);
      };
      const int expected = sign_of(d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0));
      ASSERT_EQ(orient2d(p[0], p[1], p[2]), expected);
      ASSERT_EQ(exact_orient2d(p[0], p[1], p[2]), expected);
      ASSERT_EQ(fixed_point_orient2d(p[0], p[1], p[2]), expected);
      zeros += expected == 0;
    }
  EXPECT_GT(zeros, 5000);
}

TEST(Orient3d, IsExactForIntegersInUnitsOfAnyPowerOfTwo) {
  Random random(2);
  int zeros = 0;
  for (const int most : {1, 2, 50, 1 << 18})
    for (int k = 0; k < 1000; ++k) {
      Points4 p = integers(random, most);
      if (k % 3 == 0)
        for (std::size_t axis = 0; axis < 3; ++axis) p[3][axis] = p[1][axis] + p[2][axis] - p[0][axis];
      const int expected = integer_orient3d(p);
      zeros += expected == 0;
      for (const std::array<int, 3> exponents : {std::array{0, 0, 0},
                                                 {-1074, -1074, -1074},
                                                 {1000, 1000, 1000},
                                                 {-1074, 1000, 3},
                                                 {-700, -700, 40},
                                                 {-30, 17, -5}}) {
        const Points4 q = scaled(p, exponents);
        ASSERT_EQ(orient3d(q), expected);
        ASSERT_EQ(exact_orient3d(q), expected);
        ASSERT_EQ(fixed_point_orient3d(q), expected);
      }
    }
  EXPECT_GT(zeros, 1000);
}

TEST(Orient3d, SeesTheLastBit) {
  // In the plane x + y + z = 3, then one ulp off.
  const Points4 flat{{{1, 1, 1}, {0.5, 1.25, 1.25}, {1.75, 0.125, 1.125}, {0.25, 0.25, 2.5}}};
  ASSERT_EQ(orient3d(flat), 0);
  for (std::size_t k = 0; k < 3; ++k)
    for (const double way : {-10.0, 10.0}) {
      Points4 off = flat;
      off[3][k] = std::nextafter(off[3][k], way);
      Points4 far = flat;
      far[3][k] += way;
      EXPECT_NE(orient3d(off), 0);
      EXPECT_EQ(orient3d(off), orient3d(far));
    }
}

TEST(Orient3d, TheThreeWaysAgreeOnWhatNoFilterDecides) {
  Random random(3);
  std::array<int, 3> seen{};
  const auto agree = [&](const Points4& p) {
    const int sign = fixed_point_orient3d(p);
    ++seen[static_cast<std::size_t>(sign + 1)];
    ASSERT_EQ(orient3d(p), sign);
    ASSERT_EQ(exact_orient3d(p), sign);
  };
  for (int k = 0; k < 2000; ++k) {
    const Points4 p = nearly_coplanar(random);
    agree(p);
    agree(scaled(p, {-1000, -1030, -990}));
    agree(scaled(p, {1000, 400, 1023}));
    agree(of_mixed_exponents(random, 60));
    agree(of_mixed_exponents(random, 1000));
    Points4 repeated = of_mixed_exponents(random, 1000);
    repeated[3] = repeated[1];
    agree(repeated);
    if (HasFatalFailure()) return;
  }
  for (const int count : seen) EXPECT_GT(count, 400);
}

TEST(Orient3d, SwappingTwoPointsTurnsTheSign) {
  Random random(4);
  for (int k = 0; k < 100; ++k)
    for (const Points4& p : {nearly_coplanar(random), integers(random, 2), of_mixed_exponents(random, 500)}) {
      const int sign = orient3d(p);
      std::array<std::size_t, 4> order{0, 1, 2, 3};
      do {
        int inversions = 0;
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = i + 1; j < 4; ++j) inversions += order[i] > order[j];
        ASSERT_EQ(orient3d({p[order[0]], p[order[1]], p[order[2]], p[order[3]]}),
                  inversions % 2 == 0 ? sign : -sign);
      } while (std::next_permutation(order.begin(), order.end()));
    }
}

TEST(Orient3d, ATranslationThatDoesNotRoundChangesNothing) {
  Random random(5);
  for (int k = 0; k < 2000; ++k) {
    const Points4 p = integers(random, 2);
    for (const int exponent : {3, 30, 51}) {
      Points4 moved = p;
      for (Point3& q : moved)
        for (double& x : q) x += std::ldexp(1.0, exponent);
      ASSERT_EQ(orient3d(moved), orient3d(p)) << exponent;
    }
  }
}

TEST(Orient3d, ReachesTheEndsOfTheRange) {
  constexpr double most = std::numeric_limits<double>::max();
  constexpr double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(
      orient3d({{{-most, -most, -most}, {most, -most, -most}, {-most, most, -most}, {-most, -most, most}}}), 1);
  EXPECT_EQ(orient3d({{{0, 0, 0}, {least, 0, 0}, {0, least, 0}, {0, 0, least}}}), 1);
  EXPECT_EQ(orient3d({{{0, 0, 0}, {most, 0, 0}, {0, most, 0}, {0, 0, -least}}}), -1);
  EXPECT_EQ(orient3d({{{-most, 0, 0}, {most, most, least}, {0, -most, 0}, {least, most, most}}}),
            fixed_point_orient3d({{{-most, 0, 0}, {most, most, least}, {0, -most, 0}, {least, most, most}}}));
}

}  // namespace
}  // namespace meshgraft::test
