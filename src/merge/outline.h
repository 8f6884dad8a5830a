#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// k×2, points of the plane.
using PlanePoints = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Returns whether a closed polygon does not cross itself.
bool is_simple(const PlanePoints& polygon);

/// Returns twice a closed polygon's area; negative if it runs clockwise.
double double_area(const PlanePoints& polygon);

/// A simple polygon around the origin, counter-clockwise.
class Outline {
 public:
  explicit Outline(PlanePoints points);

  /// Returns the signed distance to the outline, negative inside.
  double signed_distance(const Eigen::RowVector2d& point) const;
  /// Returns the arc length from point 0 to the point of the outline nearest to `point`.
  double arc_of_nearest(const Eigen::RowVector2d& point) const;
  double arc(Index point) const { return arcs_[point]; }
  double length() const { return arcs_.back(); }
  Index size() const { return static_cast<Index>(points_.rows()); }

  /// Returns the largest distance of a point from the origin.
  double reach() const { return points_.rowwise().norm().maxCoeff(); }
  /// Returns the square root of the area.
  double width() const;
  /// Returns the outline scaled about the origin.
  Outline scaled(double scale) const { return Outline(PlanePoints(scale * points_)); }

 private:
  struct Nearest {
    double distance, arc;
  };
  Nearest nearest(const Eigen::RowVector2d& point) const;

  PlanePoints points_;
  std::vector<double> arcs_;  // up to each point, and the whole length
};

}  // namespace meshgraft
