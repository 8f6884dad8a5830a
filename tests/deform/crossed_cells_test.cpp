#include <algorithm>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/measure/crossed_cells.h"

namespace meshgraft {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Returns a random cube that holds a point.
AlignedBox3d small_box(const Vector3d& point, double side, std::mt19937& random) {
  std::uniform_real_distribution<double> part(0, 1);
  const Vector3d low = point - side * Vector3d(part(random), part(random), part(random));
  return {low, low + side * Vector3d::Ones()};
}

/// A box that holds a point of a segment may meet it, for grids of all shapes and segments in all directions.
TEST(CrossedCells, MissNoBoxThatASegmentCrosses) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1), part(0, 1);
  for (const Vector3d& sizes : {Vector3d(1, 1, 1), Vector3d(1, 0.7, 0.01), Vector3d(3, 0.001, 0)}) {
    const AlignedBox3d around(-sizes, sizes);
    for (int time = 0; time < 200; ++time) {
      CrossedCells crossed(around, 1 << 15);
      Vector3d from = around.sample(), to = around.sample();
      if (time % 3 == 0) to = from + Vector3d::Unit(time / 3 % 3) * (time % 2 == 0 ? 1.5 : -1.5);
      if (time % 5 == 0) from += 2 * Vector3d(number(random), number(random), number(random));
      if (time % 7 == 0) from = (from * 8).array().round() / 8, to = (to * 8).array().round() / 8;
      crossed.add_segment(from, to);
      for (int place = 0; place < 50; ++place) {
        const Vector3d point = from + part(random) * (to - from);
        if (!around.contains(point)) continue;
        EXPECT_TRUE(crossed.may_meet(small_box(point, 0.001, random))) << time;
        EXPECT_TRUE(crossed.may_meet({point, point})) << time;
      }
    }
  }
}

/// A box farther from all segments than two diagonals of a cell is told apart.
TEST(CrossedCells, LeaveOutBoxesFarFromTheSegments) {
  std::mt19937 random(2);
  const AlignedBox3d around(-Vector3d::Ones(), Vector3d::Ones());
  CrossedCells crossed(around, 1 << 15);  // of 1/16
  const Vector3d from(-0.9, -0.8, -0.7), to(0.9, 0.5, 0.6);
  crossed.add_segment(from, to);
  int far = 0;
  for (int place = 0; place < 1000; ++place) {
    const Vector3d point = around.sample();
    const double along = std::clamp((point - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    if ((from + along * (to - from) - point).norm() < 0.25) continue;
    ++far;
    EXPECT_FALSE(crossed.may_meet(small_box(point, 0.001, random)));
  }
  EXPECT_GT(far, 500);
}

}  // namespace
}  // namespace meshgraft
