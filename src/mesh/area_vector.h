#pragma once

#include <algorithm>
#include <span>

#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns Newell's normal of a face, whose length is twice the area. It is computed relative to the first
/// corner, to keep precision far from the origin.
inline Eigen::Vector3d area_vector(std::span<const Index> face, const Points& positions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Eigen::Vector3d a = positions.row(face[c - 1]) - positions.row(face[0]);
    const Eigen::Vector3d b = positions.row(face[c]) - positions.row(face[0]);
    sum += a.cross(b);
  }
  return sum;
}

inline Eigen::Vector3d area_vector(const Triangles& triangles, Eigen::Index t, const Points& positions) {
  return area_vector({triangles.row(t).data(), 3}, positions);
}

/// Returns the cotangent of a triangle's angle at `apex`, within ±1000 for slivers.
inline double clamped_cotangent(const Eigen::Vector3d& apex, const Eigen::Vector3d& a,
                                const Eigen::Vector3d& b) {
  constexpr double most = 1e3;
  const double area = (a - apex).cross(b - apex).norm(), dot = (a - apex).dot(b - apex);
  return std::clamp(area > 0 ? dot / area : most, -most, most);
}

/// Returns twice the signed area of the triangle 0, a, b in the plane.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace meshgraft
