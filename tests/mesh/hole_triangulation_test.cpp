#include "mesh/repair/hole_triangulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/shapes.h"
#include "support/hole_families.h"

namespace meshgraft {
namespace {

using test::HoleCase;
using test::HoleCost;
using HoleTriangles = std::vector<HoleTriangle>;

HoleTriangles fill(const HoleCase& hole, const HoleTriangulationOptions& options = {},
                   const Context& context = {}) {
  return triangulate_hole({hole.points, hole.beyond}, options, context);
}

void expect_equal(const HoleCost& a, const HoleCost& b, double scale = 1) {
  EXPECT_NEAR(a.angle, b.angle, 2e-9);
  EXPECT_NEAR(a.area, b.area * scale * scale, 1e-7 * a.area);
}

HoleCase random_hole(Index n, unsigned seed) {
  std::mt19937 random(seed);
  const auto coordinate = [&] { return static_cast<double>(random()) / 4294967296.0; };
  HoleCase hole{"random", Points(n, 3), Points(seed % 2 ? n : 0, 3)};
  for (double& x : hole.points.reshaped()) x = coordinate();
  for (double& x : hole.beyond.reshaped()) x = coordinate();
  return hole;
}

// Calls `visit` with `made` followed by every triangulation of the polygons behind the chords in `open`.
template <class Visit>
void for_each_triangulation(std::vector<HoleChord> open, HoleTriangles& made, const Visit& visit) {
  while (!open.empty() && open.back()[1] - open.back()[0] == 1) open.pop_back();
  if (open.empty()) return visit(made);
  const auto [from, to] = open.back();
  open.pop_back();
  for (Index apex = from + 1; apex < to; ++apex) {
    std::vector<HoleChord> rest = open;
    rest.push_back({from, apex});
    rest.push_back({apex, to});
    made.push_back({from, apex, to});
    for_each_triangulation(rest, made, visit);
    made.pop_back();
  }
}

bool uses(const HoleTriangles& faces, const HoleChord& chord) {
  return std::any_of(faces.begin(), faces.end(), [&](const HoleTriangle& face) {
    return std::count(face.begin(), face.end(), chord[0]) + std::count(face.begin(), face.end(), chord[1]) == 2;
  });
}

HoleCost best_of_all(const HoleCase& hole, const std::vector<HoleChord>& forbidden) {
  HoleCost best{std::numeric_limits<double>::infinity(), 0};
  HoleTriangles made;
  for_each_triangulation({{0, hole.size() - 1}}, made, [&](const HoleTriangles& faces) {
    for (const HoleChord& chord : forbidden)
      if (uses(faces, chord)) return;
    const HoleCost cost = hole_cost(hole, faces);
    const bool same = std::abs(cost.angle - best.angle) <= 1e-9;
    if (same ? cost.area < best.area : cost.angle < best.angle) best = cost;
  });
  return best;
}

TEST(HoleTriangulation, CoversEveryFamily) {
  for (const HoleCase& hole : test::hole_cases(300)) {
    SCOPED_TRACE(hole.name());
    EXPECT_EQ(test::hole_faults(hole.size(), fill(hole)), "");
  }
}

TEST(HoleTriangulation, IsTheBestOfAll) {
  for (Index n = 4; n <= 9; ++n)
    for (unsigned seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(std::to_string(n) + " points, seed " + std::to_string(seed));
      const HoleCase hole = random_hole(n, seed);
      expect_equal(hole_cost(hole, fill(hole)), best_of_all(hole, {}));
      const std::vector<HoleChord> forbidden{{0, 2}, {1, n - 1}};
      const HoleTriangles faces = fill(hole, {.forbidden = forbidden});
      if (n == 4) {
        EXPECT_TRUE(faces.empty());  // both diagonals are forbidden
        continue;
      }
      for (const HoleChord& chord : forbidden) EXPECT_FALSE(uses(faces, chord));
      expect_equal(hole_cost(hole, faces), best_of_all(hole, forbidden));
    }
}

TEST(HoleTriangulation, KeepsForbiddenEdgesOutOfLargeHoles) {
  const HoleCase hole = test::make_hole("saddle", 400, true);
  std::vector<HoleChord> forbidden;
  for (const auto& [a, b, c] : fill(hole))
    if (c - a > 40 && c - a < 360) forbidden.push_back({a, c});
  ASSERT_FALSE(forbidden.empty());
  const HoleTriangles faces = fill(hole, {.forbidden = forbidden});
  EXPECT_EQ(test::hole_faults(hole.size(), faces), "");
  for (const HoleChord& chord : forbidden) EXPECT_FALSE(uses(faces, chord));
}

TEST(HoleTriangulation, IsAsGoodWhereverTheHoleIsAndWhereverItBegins) {
  const Eigen::Affine3d motion = Eigen::Translation3d(3, -2, 5) *
                                 Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -1, 2).normalized()) *
                                 Eigen::UniformScaling<double>(7);
  for (const std::string& family : test::hole_family_names()) {
    const HoleCase hole = test::make_hole(family, 30, true);
    SCOPED_TRACE(hole.name());
    const HoleCost cost = hole_cost(hole, fill(hole));
    HoleCase moved = hole, begun = hole;
    for (Points* points : {&moved.points, &moved.beyond})
      *points = (motion * points->transpose().eval()).transpose().eval();
    expect_equal(hole_cost(moved, fill(moved)), cost, 7);
    for (Index k = 0; k < hole.size(); ++k) {
      begun.points.row(k) = hole.points.row((k + 11) % hole.size());
      begun.beyond.row(k) = hole.beyond.row((k + 11) % hole.size());
    }
    expect_equal(hole_cost(begun, fill(begun)), cost);
  }
}

TEST(HoleTriangulation, TakesOddLoops) {
  HoleCase square{"square", Points(4, 3), Points(0, 3)};
  square.points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  EXPECT_EQ(test::hole_faults(4, fill(square)), "");
  EXPECT_EQ(triangulate_hole({square.points.topRows(3)}).size(), 1);
  EXPECT_TRUE(triangulate_hole({square.points.topRows(2)}).empty());
  HoleCase broken = square;
  broken.points(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(fill(broken).empty());
  HoleCase repeated = square;
  repeated.points.row(2) = repeated.points.row(1);
  EXPECT_EQ(test::hole_faults(4, fill(repeated)), "");
  HoleCase line = random_hole(7, 0);
  line.points.rightCols(2).setZero();
  EXPECT_EQ(test::hole_faults(7, fill(line)), "");
}

// The hole is a square with a vertex in the middle of each side; a triangle of three vertices on a side has
// no area.
TEST(HoleTriangulation, AvoidsTrianglesWithoutArea) {
  HoleCase hole{"square", Points(8, 3), Points(0, 3)};
  hole.points << 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 2, 2, 0, 1, 2, 0, 0, 2, 0, 0, 1, 0;
  for (const auto& [a, b, c] : fill(hole)) {
    const Eigen::RowVector3d p = hole.points.row(a);
    EXPECT_GT((hole.points.row(b) - p).cross(hole.points.row(c) - p).norm(), 0.1);
  }
}

TEST(HoleTriangulation, DoesNotDependOnThreads) {
  for (const Index edges : {60, 400}) {
    const HoleCase hole = test::make_hole("ragged", edges, true);
    EXPECT_EQ(fill(hole, {}, shapes::with_threads(1)), fill(hole, {}, shapes::with_threads(4)));
  }
}

}  // namespace
}  // namespace meshgraft
