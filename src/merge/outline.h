#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// k×2, points of the plane.
using PlanePoints = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Whether a closed polygon does not cross itself.
bool is_simple(const PlanePoints& polygon);

/// Twice a closed polygon's area; negative if it runs clockwise.
double double_area(const PlanePoints& polygon);

/// A simple polygon, counter-clockwise, to be drawn around the origin.
class Outline {
 public:
  explicit Outline(PlanePoints points);

  /// Negative inside.
  double signed_distance(const Eigen::RowVector2d& point) const;
  /// Length along the outline, from point 0 on, up to the place nearest to a point.
  double arc_of_nearest(const Eigen::RowVector2d& point) const;
  double arc(Index point) const { return arcs_[static_cast<std::size_t>(point)]; }
  double length() const { return arcs_.back(); }
  Index size() const { return static_cast<Index>(points_.rows()); }

  /// Largest distance from the origin.
  double reach() const { return points_.rowwise().norm().maxCoeff(); }
  /// Root of its area.
  double width() const;

 private:
  struct Nearest {
    double distance, arc;
  };
  Nearest nearest(const Eigen::RowVector2d& point) const;

  PlanePoints points_;
  std::vector<double> arcs_;  // up to each point, and once round
};

}  // namespace meshgraft
