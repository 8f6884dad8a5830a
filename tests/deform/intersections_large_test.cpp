// Intersections are counted also where the boxes of very many triangles overlap.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <random>
#include <stop_token>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>

namespace meshgraft::test {
namespace {

struct Crowd {
  Points points;
  Triangles triangles;

  explicit Crowd(Index count) : points(3 * count, 3), triangles(count, 3) {
    for (Index t = 0; t < count; ++t) triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }

  std::int64_t count(const Context& context = {}) const {
    std::vector<Index> free(static_cast<std::size_t>(points.rows()));
    std::iota(free.begin(), free.end(), Index{0});
    return count_self_intersections(points, triangles, free, context);
  }
};

// Returns parallel triangles, one above the other, that do not touch although all their boxes overlap.
Crowd stack(Index count, const Eigen::RowVector2d& slope) {
  Crowd crowd(count);
  for (Index t = 0; t < count; ++t) {
    const double z = 1e-6 * t;
    crowd.points.middleRows(3 * t, 3) << 0, 0, z, 1, 0, z + slope[0], 0, 1, z + slope[1];
  }
  return crowd;
}

Crowd in_a_cube(Index count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(0, 1);
  Crowd crowd(count);
  for (double& x : crowd.points.reshaped()) x = coordinate(random);
  return crowd;
}

TEST(IntersectionsLarge, AStackHasFiveBillionPairsOfBoxesAndNoIntersection) {
  EXPECT_EQ(stack(100'000, {1, 1}).count(), 0);
  EXPECT_EQ(stack(100'000, {0.3, 0.7}).count(), 0);
}

TEST(IntersectionsLarge, AStackWithOneTriangleThroughItHasAsManyAsItHasLayers) {
  constexpr Index layers = 20'000;
  Crowd crowd = stack(layers + 1, {0.3, 0.7});
  crowd.points.bottomRows(3) << 0.2, 0.2, -1, 0.3, 0.2, -1, 0.2, 0.2, 5;
  EXPECT_EQ(crowd.count(), layers);
}

TEST(IntersectionsLarge, ALargeFanHasNone) {
  constexpr Index count = 5000;
  Crowd crowd(count);
  for (Index t = 0; t < count; ++t) {
    const double angle = 2 * std::numbers::pi * t / count, x = std::cos(angle), y = std::sin(angle);
    crowd.points.middleRows(3 * t, 3) << 0, 0, 0, x, y, 0.3 * x + 0.1 * y, 0, 0, 0;
    crowd.triangles.row(t) << 0, 3 * t + 1, 3 * ((t + 1) % count) + 1;
  }
  EXPECT_EQ(crowd.count(), 0);
}

TEST(IntersectionsLarge, WhatTakesLongTellsHowFarItIsAndCanBeStopped) {
  const Crowd crowd = in_a_cube(12'000);
  std::stop_source stop;
  int told = 0;
  const auto tell = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "intersections");
    EXPECT_GE(progress.fraction, 0);
    EXPECT_LE(progress.fraction, 1);
    if (++told == 2) stop.request_stop();
  };
  EXPECT_THROW(crowd.count({.progress = tell, .stop_token = stop.get_token()}), Error);
  EXPECT_EQ(told, 2);
}

}  // namespace
}  // namespace meshgraft::test
