#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/merge/correspondence.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A closed polyline measured by length. Place k + t is (1 − t)·point k + t·point k + 1, cyclically.
class LoopCurve {
 public:
  explicit LoopCurve(const Points& points);

  Index size() const { return static_cast<Index>(arcs_.size()) - 1; }
  double length() const { return arcs_.back(); }
  double arc(Index vertex) const { return arcs_[vertex]; }
  /// Forwards from one vertex to another; once round if they are the same.
  double length_between(Index from, Index to) const;
  /// At a length from vertex 0, cyclically.
  double parameter_at(double arc) const;

 private:
  std::vector<double> arcs_;  ///< from vertex 0 to each vertex, and once round
};

/// The row at a parameter k + t of a closed polyline of values.
Eigen::RowVector3d at(const Points& values, double parameter);

/// Unit normal of the area that a loop spans (Newell), counter-clockwise.
Eigen::RowVector3d loop_axis(const Points& points);

/// The similarity that fits `to` ≈ scale · rotation · from + translation best (Umeyama 1991), with weights.
/// False where the points leave its rotation open: all (nearly) on a line.
bool fit_similarity(const Points& from, const Points& to, const Eigen::VectorXd& weights, Similarity& best);

}  // namespace meshgraft
