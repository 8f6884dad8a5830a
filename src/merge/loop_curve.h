#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A closed polyline parametrised by vertices and measured by arc length. Parameter k + t is the point
/// (1 − t)·point k + t·point k + 1, cyclically.
class LoopCurve {
 public:
  explicit LoopCurve(const Points& points);

  Index size() const { return static_cast<Index>(arcs_.size()) - 1; }
  double length() const { return arcs_.back(); }
  double arc(Index vertex) const { return arcs_[vertex]; }
  /// Returns the length forwards from one vertex to another; the whole length if they are the same.
  double length_between(Index from, Index to) const;
  /// Returns the parameter at an arc length from vertex 0, cyclically.
  double parameter_at(double arc) const;

 private:
  std::vector<double> arcs_;  ///< from vertex 0 to each vertex, and the whole length
};

/// Returns the row at a parameter k + t of a closed polyline of values.
Eigen::RowVector3d at(const Points& values, double parameter);

/// Returns the unit normal of the area that a loop spans (Newell), counter-clockwise.
Eigen::RowVector3d loop_axis(const Points& points);

/// Computes the similarity that best fits `to` ≈ scale · rotation · from + translation (Umeyama 1991), with
/// weights. Returns false where the points do not determine the rotation: all (nearly) on a line.
bool fit_similarity(const Points& from, const Points& to, const Eigen::VectorXd& weights, Similarity& best);

}  // namespace meshgraft
