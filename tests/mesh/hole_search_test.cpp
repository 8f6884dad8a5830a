#include "mesh/repair/hole_search.h"

#include <algorithm>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace meshgraft {
namespace {

HoleLoop random_loop(Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  HoleLoop loop{Points(n, 3)};
  for (Eigen::Index k = 0; k < loop.points.size(); ++k) loop.points.data()[k] = uniform(random);
  return loop;
}

std::vector<HoleChord> every_chord(Index n) {
  std::vector<HoleChord> chords;
  for (Index i = 0; i < n; ++i)
    for (Index k = i + 2; k < n; ++k)
      if (k - i < n - 1) chords.push_back({i, k});
  return chords;
}

double area(const HoleLoop& loop, const HoleTriangle& t) {
  const Eigen::RowVector3d ab = loop.points.row(t[1]) - loop.points.row(t[0]);
  const Eigen::RowVector3d ac = loop.points.row(t[2]) - loop.points.row(t[0]);
  return ab.cross(ac).norm() / 2;
}

// Returns the smallest area of all triangulations between two points of a loop.
double least_area(const HoleLoop& loop, Index from, Index to) {
  double least = to - from < 2 ? 0 : std::numeric_limits<double>::infinity();
  for (Index k = from + 1; k < to; ++k)
    least = std::min(least, area(loop, {from, k, to}) + least_area(loop, from, k) + least_area(loop, k, to));
  return least;
}

TEST(SearchTriangulation, HasTheSmallestAreaOfAll) {
  for (Index n = 4; n < 10; ++n)
    for (unsigned seed = 0; seed < 5; ++seed) {
      const HoleLoop loop = random_loop(n, seed);
      const auto triangles = search_triangulation(loop, every_chord(n), HoleAim::area);
      ASSERT_EQ(triangles.size(), n - 2);
      double sum = 0;
      for (const HoleTriangle& t : triangles) sum += area(loop, t);
      EXPECT_NEAR(sum, least_area(loop, 0, n - 1), 1e-12);
    }
}

TEST(SearchTriangulation, UsesTheGivenChordsAlone) {
  constexpr Index n = 9;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const HoleLoop loop = random_loop(n, seed);
    std::vector<HoleChord> chords;  // those that the first corner does not have
    for (const HoleChord& chord : every_chord(n))
      if (chord[0] != 0) chords.push_back(chord);
    for (const HoleAim aim : {HoleAim::angle, HoleAim::area, HoleAim::smooth}) {
      const auto triangles = search_triangulation(loop, chords, aim);
      ASSERT_EQ(triangles.size(), n - 2);
      EXPECT_EQ(std::ranges::count_if(triangles, [](const HoleTriangle& t) { return t[0] == 0; }), 1);
      EXPECT_TRUE(std::ranges::count(triangles, HoleTriangle{0, 1, n - 1}));
    }
    EXPECT_TRUE(search_triangulation(loop, std::vector<HoleChord>{}).empty());
  }
}

TEST(BendBetween, OrdersAngles) {
  const Eigen::Vector3d from(0, 0, 0), to(0, 0, 2), inner(-1, 0, 1);
  double before = -1;
  for (const double angle : {0.0, 1e-7, 0.1, 1.0, 2.0, 3.0}) {
    const Eigen::Vector3d outer(std::cos(angle), std::sin(angle), 1);
    const double bend = bend_between(from, to, inner, outer);
    EXPECT_NEAR(bend, 4 * std::pow(std::sin(angle / 2), 2), 1e-9 * bend + 1e-30);
    EXPECT_GT(bend, before);
    before = bend;
  }
  EXPECT_EQ(bend_between(from, to, inner, from), 0);
}

}  // namespace
}  // namespace meshgraft
