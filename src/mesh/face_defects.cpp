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

bool has_no_area(std::span<const Index> face, const Points& positions) {
  constexpr double area_rel = 1e-12;
  constexpr double ulps = 4;
  const std::size_t n = face.size();
  const Eigen::RowVector3d origin = positions.row(face[0]);
  Eigen::RowVector3d area = Eigen::RowVector3d::Zero();  // Newell's normal: twice the area
  double longest_squared = 0;
  double largest = 0;
  Eigen::RowVector3d a = Eigen::RowVector3d::Zero();
  for (std::size_t c = 0; c < n; ++c) {
    const Eigen::RowVector3d point = positions.row(face[c + 1 < n ? c + 1 : 0]);
    const Eigen::RowVector3d b = point - origin;
    area += a.cross(b);
    longest_squared = std::max(longest_squared, (b - a).squaredNorm());
    largest = std::max(largest, point.cwiseAbs().maxCoeff());
    a = b;
  }
  const double longest = std::sqrt(longest_squared);
  const double precision = ulps * std::numeric_limits<double>::epsilon() * largest;
  return area.norm() <= std::max(area_rel * longest, precision) * longest;
}

}  // namespace meshgraft
