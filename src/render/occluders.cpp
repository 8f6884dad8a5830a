#include "occluders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <meshoptimizer.h>

#include "core/parallel.h"

namespace meshgraft::render {

namespace {

/// Vertices that stand for others.
struct Merged {
  std::vector<unsigned int> number;  ///< by vertex: that of its cell
  std::vector<Eigen::Vector3f> points;
};

Merged merge_in_cells(const std::vector<Eigen::Vector3f>& points, float cell, const Context& context) {
  std::vector<std::array<float, 3>> cells(points.size());
  parallel_blocks(
      points.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
          for (std::size_t k = 0; k < 3; ++k)
            cells[v][k] = std::floor(points[v][static_cast<Eigen::Index>(k)] / cell) + 0.0f;  // -0 is 0
      },
      context, 4096);
  Merged merged;
  merged.number.resize(points.size());
  const std::size_t count = meshopt_generateVertexRemap(merged.number.data(), nullptr, points.size(),
                                                        cells.data(), points.size(), sizeof(cells.front()));
  merged.points.assign(count, Eigen::Vector3f::Zero());
  std::vector<float> members(count, 0.0f);
  for (std::size_t v = 0; v < points.size(); ++v) {
    merged.points[merged.number[v]] += points[v];
    members[merged.number[v]] += 1.0f;
  }
  for (std::size_t k = 0; k < count; ++k) merged.points[k] /= members[k];
  return merged;
}

}  // namespace

Occluders make_occluders(const std::vector<Eigen::Vector3f>& points, const Triangles& triangles, float cell,
                         const Context& context) {
  constexpr Eigen::Index many = 500'000;
  constexpr float least_lift = 2e-4f;
  Occluders occluders{{}, least_lift};
  const auto add = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
    occluders.triangles.push_back({a, b, c});
  };
  if (triangles.rows() <= many) {
    occluders.triangles.reserve(static_cast<std::size_t>(triangles.rows()));
    for (const auto& corners : triangles.rowwise())
      add(points[static_cast<std::size_t>(corners[0])], points[static_cast<std::size_t>(corners[1])],
          points[static_cast<std::size_t>(corners[2])]);
    return occluders;
  }
  occluders.lift = std::max(0.5f * cell, least_lift);
  const Merged merged = merge_in_cells(points, cell, context);
  for (const auto& corners : triangles.rowwise()) {
    const auto number = [&](int c) { return merged.number[static_cast<std::size_t>(corners[c])]; };
    const unsigned int a = number(0), b = number(1), c = number(2);
    if (a != b && b != c && c != a) add(merged.points[a], merged.points[b], merged.points[c]);
  }
  return occluders;
}

}  // namespace meshgraft::render
