#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

/// Closed polylines of many shapes, for the algorithms on loops.
namespace meshgraft::test {

struct ClosedCurve {
  std::string name;
  Points points;  ///< k×3, distinct, counter-clockwise about +z

  Index size() const { return static_cast<Index>(points.rows()); }
};

/// Returns points of a curve around z. `shape` takes an angle to radius and height.
inline Points around_z(int count, const std::function<Eigen::Vector2d(double)>& shape) {
  Points points(count, 3);
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.2 * std::sin(7.0 * k)) / count;  // uneven edges
    const Eigen::Vector2d at = shape(angle);
    points.row(k) << at.x() * std::cos(angle), at.x() * std::sin(angle), at.y();
  }
  return points;
}

/// Returns flat and bent curves, convex and star-shaped, of few and many points.
inline std::vector<ClosedCurve> closed_curves() {
  using Shape = std::function<Eigen::Vector2d(double)>;
  const std::vector<std::pair<std::string, Shape>> shapes{
      {"circle", [](double) { return Eigen::Vector2d(1, 0); }},
      {"ellipse", [](double a) { return Eigen::Vector2d(2 / std::hypot(2 * std::cos(a), std::sin(a)), 0.5); }},
      {"star", [](double a) { return Eigen::Vector2d(1 + 0.3 * std::cos(3 * a + 0.4), 0); }},
      {"wave", [](double a) { return Eigen::Vector2d(1, 0.3 * std::sin(2 * a)); }},
      {"saddle star",
       [](double a) { return Eigen::Vector2d(1 + 0.2 * std::sin(4 * a), 0.25 * std::cos(2 * a + 1)); }}};
  std::vector<ClosedCurve> curves;
  for (const auto& [name, shape] : shapes)
    for (const int count : {5, 12, 41})
      curves.push_back({name + " of " + std::to_string(count), around_z(count, shape)});
  return curves;
}

/// Returns the points with row i + `shift` first, cyclically.
inline Points rotated_rows(const Points& points, Eigen::Index shift) {
  Points result(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) result.row(i) = points.row((i + shift) % points.rows());
  return result;
}

/// Returns similarities: a turn, a shift, large and small scales, far from the origin.
inline std::vector<Eigen::Affine3d> similarities() {
  std::vector<Eigen::Affine3d> maps;
  for (const double scale : {1.0, 0.01, 50.0}) {
    Eigen::Affine3d map(Eigen::AngleAxisd(0.4 + scale, Eigen::Vector3d(1, -2, scale).normalized()));
    map.linear() *= scale;
    map.pretranslate(Eigen::Vector3d(3 * scale, -1, 2));
    maps.push_back(map);
  }
  return maps;
}

inline Points mapped(const Points& points, const Eigen::Affine3d& map) {
  return (points * map.linear().transpose()).rowwise() + map.translation().transpose();
}

}  // namespace meshgraft::test
