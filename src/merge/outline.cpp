#include "outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh/area_vector.h"

namespace meshgraft {

namespace {

// Returns whether two segments intersect or touch.
bool segments_meet(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b, const Eigen::RowVector2d& c,
                   const Eigen::RowVector2d& d) {
  if ((a.cwiseMax(b).array() < c.cwiseMin(d).array()).any()) return false;
  if ((c.cwiseMax(d).array() < a.cwiseMin(b).array()).any()) return false;
  const Eigen::RowVector2d ab = b - a, cd = d - c;
  return cross(ab, c - a) * cross(ab, d - a) <= 0 && cross(cd, a - c) * cross(cd, b - c) <= 0;
}

}  // namespace

bool is_simple(const PlanePoints& polygon) {
  const Eigen::Index n = polygon.rows();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (segments_meet(polygon.row(i), polygon.row(i + 1), polygon.row(j), polygon.row((j + 1) % n)))
        return false;
    }
  return true;
}

double double_area(const PlanePoints& polygon) {
  double sum = 0;
  for (Eigen::Index i = 0; i < polygon.rows(); ++i)
    sum += cross(polygon.row(i), polygon.row((i + 1) % polygon.rows()));
  return sum;
}

Outline::Outline(PlanePoints points) : points_(std::move(points)), arcs_{0.0} {
  for (Eigen::Index i = 0; i < points_.rows(); ++i)
    arcs_.push_back(arcs_.back() + (points_.row((i + 1) % points_.rows()) - points_.row(i)).norm());
}

Outline::Nearest Outline::nearest(const Eigen::RowVector2d& point) const {
  Nearest best{std::numeric_limits<double>::infinity(), 0};
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    const Eigen::RowVector2d a = points_.row(i), edge = points_.row((i + 1) % points_.rows()) - points_.row(i);
    const double square = edge.squaredNorm();
    const double t = square > 0 ? std::clamp((point - a).dot(edge) / square, 0.0, 1.0) : 0.0;
    const double distance = (point - a - t * edge).norm();
    if (distance < best.distance) best = {distance, arcs_[i] + t * std::sqrt(square)};
  }
  return best;
}

double Outline::signed_distance(const Eigen::RowVector2d& point) const {
  bool inside = false;
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    const Eigen::RowVector2d a = points_.row(i), b = points_.row((i + 1) % points_.rows());
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x = a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y());
    if (x > point.x()) inside = !inside;
  }
  const double distance = nearest(point).distance;
  return inside ? -distance : distance;
}

double Outline::arc_of_nearest(const Eigen::RowVector2d& point) const { return nearest(point).arc; }

double Outline::width() const { return std::sqrt(std::abs(double_area(points_)) / 2); }

}  // namespace meshgraft
