#include "decimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include <meshoptimizer.h>
#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft {

namespace {

/// Returns a pseudo-random value in −1 … 1 for a number (the finaliser of SplitMix64).
double drawn(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
  number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
  number ^= number >> 31;
  return static_cast<double>(number >> 11) * 0x1p-52 - 1;
}

double surface_area(const Points& points, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles.rowwise()) {
    const Eigen::RowVector3d u = points.row(t[1]) - points.row(t[0]), v = points.row(t[2]) - points.row(t[0]);
    sum += u.cross(v).norm() / 2;
  }
  return sum;
}

/// Returns positions for the simplifier, in the unit box. The simplifier keeps vertices where the surface is
/// curved and none where it is flat, but a deformation bends both. So each vertex is moved along its normal
/// by a random fraction of the wanted edge length. The surface is then equally rough everywhere, and the
/// remaining vertices are evenly spread. The median and 99th percentile of the edges are 1.15 and 2.2 times
/// the even length, instead of 0.8 and 24.
std::vector<float> roughened(const Points& points, const Points& normals, double edge_length) {
  constexpr double roughness = 0.15;
  const Eigen::RowVector3d low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? 1 / extent : 1;
  std::vector<float> coordinates;
  coordinates.reserve(points.size());
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const double lift = roughness * edge_length * drawn(static_cast<std::uint64_t>(v));
    const Eigen::RowVector3d lifted = (points.row(v) - low + lift * normals.row(v)) * scale;
    for (const double x : lifted) coordinates.push_back(static_cast<float>(x));
  }
  return coordinates;
}

/// Returns the triangles' corners, and for each locked vertex a face that has only this vertex as its
/// corners. The simplifier moves no vertex of such a face.
std::vector<unsigned> corners_with_locks(const Triangles& triangles, std::span<const std::uint8_t> locked) {
  std::vector<unsigned> corners(triangles.data(), triangles.data() + triangles.size());
  for (std::size_t v = 0; v < locked.size(); ++v)
    if (locked[v]) corners.insert(corners.end(), 3, static_cast<unsigned>(v));
  return corners;
}

/// Removes pairs of faces back to back. The simplifier makes them where it closes a pocket of the surface.
void drop_closed_pockets(std::vector<Index>& corners) {
  const std::size_t count = corners.size() / 3;
  std::vector<std::array<Index, 3>> sorted(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3, sorted[t].begin());
    std::sort(sorted[t].begin(), sorted[t].end());
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(sorted[a], a) < std::pair(sorted[b], b); });
  Flags dropped(count, 0);
  for (std::size_t i = 0; i + 1 < count; ++i)
    if (sorted[order[i]] == sorted[order[i + 1]]) dropped[order[i]] = dropped[order[i + 1]] = 1;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < count; ++t) {
    if (dropped[t]) continue;
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(3 * t), 3,
                corners.begin() + static_cast<std::ptrdiff_t>(3 * kept++));
  }
  corners.resize(3 * kept);
}

Decimated gather(std::span<const unsigned> corners, Eigen::Index vertex_count) {
  std::vector<Index> kept;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const unsigned a = corners[t], b = corners[t + 1], c = corners[t + 2];
    if (a == b || b == c || c == a) continue;
    for (const unsigned v : {a, b, c}) kept.push_back(static_cast<Index>(v));
  }
  drop_closed_pockets(kept);
  std::vector<Index> coarse_index(vertex_count, -1);
  for (const Index v : kept) coarse_index[v] = 0;
  Decimated result;
  for (std::size_t v = 0; v < coarse_index.size(); ++v) {
    if (coarse_index[v] < 0) continue;
    coarse_index[v] = static_cast<Index>(result.vertices.size());
    result.vertices.push_back(static_cast<Index>(v));
  }
  result.triangles.resize(static_cast<Eigen::Index>(kept.size() / 3), 3);
  std::transform(kept.begin(), kept.end(), result.triangles.data(), [&](Index v) { return coarse_index[v]; });
  return result;
}

}  // namespace

Decimated decimate(const Points& points, const Triangles& triangles, const Points& normals,
                   std::span<const std::uint8_t> locked, Index target, const Context& context) {
  // Data that the simplifier owns, so that a cancelled caller can leave it behind.
  struct Simplification {
    std::vector<unsigned> corners, left;
    std::vector<float> coordinates;
    std::size_t target_corners = 0, count = 0;
  };
  const auto s = std::make_shared<Simplification>();
  s->corners = corners_with_locks(triangles, locked);
  s->coordinates = roughened(points, normals, std::sqrt(surface_area(points, triangles) / target));
  // A closed surface has twice as many faces as vertices, one with boundary has fewer.
  s->target_corners = std::min(6 * static_cast<std::size_t>(target), s->corners.size());
  s->left.resize(s->corners.size());
  run_abandonable(
      [s] {
        constexpr float any_error = std::numeric_limits<float>::max();
        s->count = meshopt_simplify(s->left.data(), s->corners.data(), s->corners.size(), s->coordinates.data(),
                                    s->coordinates.size() / 3, 3 * sizeof(float), s->target_corners, any_error,
                                    0, nullptr);
      },
      context);
  return gather(std::span(s->left).first(s->count), points.rows());
}

}  // namespace meshgraft
