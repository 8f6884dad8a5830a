#include "support/limb_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <fmt/format.h>

namespace meshgraft::test {

namespace {

constexpr int vertices_around = 48;
constexpr double limb_radius = 0.5;

/// Returns the point of a section at a fraction of its perimeter.
Eigen::RowVector2d section_point(bool square, double fraction) {
  if (!square)
    return limb_radius * Eigen::RowVector2d(std::cos(2 * std::numbers::pi * fraction),
                                            std::sin(2 * std::numbers::pi * fraction));
  const double along = 4 * (fraction - std::floor(fraction));
  const double rest = along - std::floor(along) - 0.5;
  switch (static_cast<int>(along) % 4) {
    case 0: return {limb_radius, rest};
    case 1: return {-rest, limb_radius};
    case 2: return {-limb_radius, -rest};
    default: return {rest, -limb_radius};
  }
}

/// Returns the heights of the rings: two below 0, two above `length`, and those between.
std::vector<double> ring_heights(double length, bool uneven) {
  const double step = 2 * std::numbers::pi * limb_radius / vertices_around;
  std::vector<double> heights{-2 * step, -step};
  const auto add_part = [&](double from, double to, double size) {
    const int count = std::max(1, static_cast<int>(std::round((to - from) / size)));
    for (int k = 0; k < count; ++k) heights.push_back(from + (to - from) * k / count);
  };
  add_part(0, length / 2, uneven ? step / 3 : step);
  add_part(length / 2, length, step);
  for (int k = 0; k < 3; ++k) heights.push_back(length + k * step);
  return heights;
}

}  // namespace

Limb make_limb(const LimbShape& shape) {
  Limb limb;
  limb.length = shape.radii * limb_radius;
  limb.mesh.name = fmt::format("{} limb of {} radii{}{}", shape.square ? "square" : "round", shape.radii,
                               shape.uneven ? ", uneven" : "", shape.closed ? ", closed" : "");
  const std::vector<double> heights = ring_heights(limb.length, shape.uneven);
  const auto rings = static_cast<int>(heights.size());
  const int lids = shape.closed ? 2 : 0;
  Points& points = limb.mesh.positions;
  points.resize(rings * vertices_around + lids, 3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < vertices_around; ++i) {
      const bool free = heights[j] > 0 && heights[j] < limb.length;
      // Vertices on the edges of a square pipe stay there.
      const bool edge = shape.square && i % (vertices_around / 4) == 0;
      double at = i, height = heights[j];
      if (shape.uneven && free) {
        at += edge ? 0 : jitter(random);
        height += jitter(random) * std::min(heights[j + 1] - height, height - heights[j - 1]);
      }
      points.row(j * vertices_around + i) << section_point(shape.square, at / vertices_around), height;
    }
  Triangles& triangles = limb.mesh.triangles;
  triangles.resize(2 * (rings - 1) * vertices_around + lids * vertices_around, 3);
  Eigen::Index t = 0;
  for (int j = 0; j + 1 < rings; ++j)
    for (int i = 0; i < vertices_around; ++i) {
      const int k = (i + 1) % vertices_around, a = j * vertices_around;
      const bool rising = (i + j) % 2 == 0;
      triangles.row(t++) << a + i, a + k, a + vertices_around + (rising ? k : i);
      triangles.row(t++) << a + (rising ? i : k), a + vertices_around + k, a + vertices_around + i;
    }
  for (int lid = 0; lid < lids; ++lid) {
    const int first = lid == 0 ? 0 : (rings - 1) * vertices_around;
    points.row(rings * vertices_around + lid) << 0, 0, (lid == 0 ? heights.front() : heights.back());
    for (int i = 0; i < vertices_around; ++i) {
      const int k = (i + 1) % vertices_around;
      triangles.row(t++) << first + (lid == 0 ? k : i), first + (lid == 0 ? i : k),
          rings * vertices_around + lid;
    }
  }
  for (Index v = 0; v < limb.mesh.size(); ++v) {
    const double z = points(v, 2);
    (z <= 0 ? limb.bottom : z >= limb.length ? limb.top : limb.middle).push_back(v);
  }
  return limb;
}

HandlePose top_turned(double degrees) {
  const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ());
  return {.transform = Eigen::Affine3d(turn), .rotation = turn};
}

Points helix(const Limb& limb, double degrees) {
  Points points = limb.mesh.positions;
  for (auto point : points.rowwise()) {
    const double fraction = std::clamp(point[2] / limb.length, 0.0, 1.0);
    const Eigen::AngleAxisd turn(fraction * degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ());
    point = (turn * point.transpose()).transpose().eval();
  }
  return points;
}

double waist(const Limb& limb, const Points& edited) {
  double least = std::numeric_limits<double>::max();
  for (const Index v : limb.middle)
    least = std::min(least, edited.row(v).head<2>().norm() / limb.mesh.positions.row(v).head<2>().norm());
  return least;
}

}  // namespace meshgraft::test
