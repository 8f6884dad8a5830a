#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "view.h"

namespace meshgraft::render {

/// A triangle as the eye sees it, in the coordinates of the camera. Directions are those of
/// `View::direction_to`. Nothing is divided by the depth of a corner, so that corners may lie behind the eye
/// (Olano and Greer 1997). A direction between two triangles that share an edge meets at least one of them.
class SeenTriangle {
 public:
  SeenTriangle(const Vec3& p0, const Vec3& p1, const Vec3& p2) {
    const Eigen::Vector3d a = p0.cast<double>(), b = p1.cast<double>(), c = p2.cast<double>();
    opposite_ = {b.cross(c), c.cross(a), a.cross(b)};
    normal_ = (b - a).cross(c - a);
    height_ = normal_.dot(a);
    nearest_ = -std::max({a.z(), b.z(), c.z()});
    farthest_ = -std::min({a.z(), b.z(), c.z()});
  }

  bool is_met(const Eigen::Vector3d& direction) const {
    const double a = opposite_[0].dot(direction), b = opposite_[1].dot(direction),
                 c = opposite_[2].dot(direction);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
  }

  /// Returns how far ahead of the eye a direction meets the triangle, within the depths of its corners; NaN if
  /// it is seen edge on.
  double depth(const Eigen::Vector3d& direction) const {
    return std::clamp(height_ / normal_.dot(direction), nearest_, farthest_);
  }

  /// Returns the weights of the corners at a direction that meets the triangle.
  Vec3 weights(const Eigen::Vector3d& direction) const {
    Eigen::Vector3d weights(opposite_[0].dot(direction), opposite_[1].dot(direction),
                            opposite_[2].dot(direction));
    const double sum = weights.sum();
    if (sum == 0) return Vec3::Constant(1.0f / 3.0f);
    weights = (weights / sum).cwiseMax(0.0).cwiseMin(1.0);
    return (weights / weights.sum()).cast<float>();
  }

 private:
  std::array<Eigen::Vector3d, 3> opposite_;  // normals of the planes through the eye and the opposite edge
  Eigen::Vector3d normal_;
  double height_;  // of the triangle's plane over the eye, times the length of the normal
  double nearest_, farthest_;
};

}  // namespace meshgraft::render
