#include "face_defects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace meshgraft {

bool is_vertex_of(const Mesh& mesh, Index vertex) { return vertex >= 0 && vertex < mesh.vertex_count(); }

bool in_range(std::span<const Index> face, Index vertex_count) {
  return std::all_of(face.begin(), face.end(), [&](Index v) { return v >= 0 && v < vertex_count; });
}

bool in_range(const Mesh& mesh, Index face) { return in_range(mesh.faces[face], mesh.vertex_count()); }

bool is_degenerate(std::span<const Index> face) {
  if (face.size() < 3) return true;
  if (face.size() == 3) return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
  std::vector<Index> sorted(face.begin(), face.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

namespace {

constexpr double area_rel = 1e-12;
constexpr double precision_rel = 4 * std::numeric_limits<double>::epsilon();  // relative to the coordinates

bool is_lost(double double_area, double longest, double precision) {
  return double_area <= std::max(area_rel * longest, precision) * longest;
}

// Returns a power of two that scales a length to about 1, so that products of four lengths neither overflow
// nor underflow.
double unit_scale(double length) {
  constexpr int most = 1000;
  return length > 0 && std::isfinite(length) ? std::ldexp(1, std::clamp(-std::ilogb(length), -most, most)) : 1;
}

// Returns whether a triangle certainly has an area, by a fast test with a wide margin. It decides nothing for
// lengths whose products may overflow or underflow.
bool has_clear_area(const double* a, const double* b, const double* c) {
  constexpr double margin = 16, least = 1e-60, most = 1e60;
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  const double double_area2 = x * x + y * y + z * z;
  // The longest edge is at most as long as two of the others together.
  const double longest2 =
      2 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(a[k]), std::abs(b[k]), std::abs(c[k])});
  const double precision = precision_rel * largest;
  return longest2 > least && longest2 < most && largest < most &&
         double_area2 > margin * std::max(area_rel * area_rel * longest2, precision * precision) * longest2;
}

}  // namespace

bool has_no_area(std::span<const Index> face, const Points& positions) {
  const std::size_t n = face.size();
  if (n == 3) {
    const double* const points = positions.data();
    if (has_clear_area(points + 3 * std::ptrdiff_t{face[0]}, points + 3 * std::ptrdiff_t{face[1]},
                       points + 3 * std::ptrdiff_t{face[2]}))
      return false;
  }
  const Eigen::RowVector3d origin = positions.row(face[0]);
  double largest = 0, extent = 0;
  for (const Index v : face) {
    largest = std::max(largest, positions.row(v).cwiseAbs().maxCoeff());
    extent = std::max(extent, (positions.row(v) - origin).cwiseAbs().maxCoeff());
  }
  const double scale = unit_scale(extent);
  Eigen::RowVector3d area = Eigen::RowVector3d::Zero();  // Newell's normal: twice the area
  double longest_squared = 0;
  Eigen::RowVector3d a = Eigen::RowVector3d::Zero();
  for (std::size_t c = 0; c < n; ++c) {
    const Eigen::RowVector3d b = scale * (positions.row(face[c + 1 < n ? c + 1 : 0]) - origin);
    area += a.cross(b);
    longest_squared = std::max(longest_squared, (b - a).squaredNorm());
    a = b;
  }
  return is_lost(area.norm(), std::sqrt(longest_squared), precision_rel * largest * scale);
}

bool has_no_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double largest) {
  Eigen::Vector3d u = b - a, v = c - a;
  const double scale = unit_scale(std::max(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()));
  u *= scale;
  v *= scale;
  const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()}));
  return is_lost(u.cross(v).norm(), longest, precision_rel * largest * scale);
}

}  // namespace meshgraft
